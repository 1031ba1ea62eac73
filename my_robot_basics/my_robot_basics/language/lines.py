"""Break a text into lines: Chinese has no spaces to break at, and its characters are wide."""

import re
import textwrap

from wcwidth import width

_HAN = '\u3400-\u9fff'
_OPENING, _CLOSING = '（“《', '，。；：！？、）”》'
_PIECE = re.compile(
    rf'\s*[{_OPENING}]*(?:[{_HAN}]|(?:(?![{_HAN}{_OPENING}])\S)+|(?=\s|$))[{_CLOSING}]*'
)
"""What is not broken: a word, or a Chinese character, with the punctuation that belongs to it."""


def in_lines(text: str, columns: int, *, first: str = '', rest: str = '') -> list[str]:
    """Return the lines of a text, each of at most `columns` columns; longer words stay whole.

    `first` is put before the first line, `rest` before the others.
    """
    if text.isascii():
        return textwrap.wrap(
            text,
            columns,
            initial_indent=first,
            subsequent_indent=rest,
            break_long_words=False,
            break_on_hyphens=False,
        )
    lines, line = [], first
    is_empty = True
    for piece in filter(str.strip, _PIECE.findall(text.replace('\n', ' '))):
        if not is_empty and width(line + piece) > columns:
            lines.append(line)
            line, is_empty = rest, True
        line += piece.lstrip() if is_empty else piece
        is_empty = False
    return lines if is_empty else [*lines, line]
