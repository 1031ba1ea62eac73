"""Make text that students wrote safe to print, and cut it to a width."""

import unicodedata


def printable(text: object) -> str:
    """Return one line in which escapes, controls and direction marks are spelled out."""
    line = ' '.join(str(text).split())
    return ''.join(
        c if c.isprintable() else c.encode('unicode_escape', 'replace').decode() for c in line
    )


def shorten(text: str, width: int) -> str:
    """Return at most `width` columns of a line, an ellipsis where something was cut."""
    if columns(text) <= width:
        return text
    kept = ''
    for character in text:
        if columns(kept + character) >= width:
            break
        kept += character
    return kept + '…'


def columns(text: str) -> int:
    """Return how many columns of a terminal a line takes: ideographs take two."""
    return sum(
        0 if unicodedata.combining(c) else 2 if unicodedata.east_asian_width(c) in 'WF' else 1
        for c in text
    )
