"""Characters of word processors and of other keyboards, and what is expected in their place."""

import unicodedata

_MARKS = {
    **dict.fromkeys('‘’‚‛′', "'"),
    **dict.fromkeys('“”„‟″', '"'),
    **dict.fromkeys('‐‑‒–—−', '-'),
    **{'。': '.', '、': ',', '【': '[', '】': ']', '《': '<', '》': '>', '×': '*', '÷': '/'},
}


def in_ascii(character: str) -> str:
    """Return the ASCII character to write in place of this one; '' if it is none of those."""
    plain = unicodedata.normalize('NFKC', character)
    is_wide = unicodedata.east_asian_width(character) == 'F' and plain.isascii()
    return _MARKS.get(character, plain if is_wide else '')


def is_wide(character: str) -> bool:
    """Whether it is as wide as two letters, such as most that a Chinese keyboard types."""
    return unicodedata.east_asian_width(character) in ('F', 'W')


def is_invisible(character: str) -> bool:
    """Whether it has no width, such as a byte order mark or a mark of the text's direction."""
    return unicodedata.category(character) == 'Cf'
