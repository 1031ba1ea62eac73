"""Say which character of a line a definition cannot have."""

import re
import unicodedata

from my_robot_basics.feedback.characters import in_ascii, is_invisible, is_wide


def about_characters(line: str) -> str:
    """Say which character of another keyboard, or comment of another language, a line has."""
    for character in line:
        if unicodedata.normalize('NFKC', character) == ' ' != character:
            return 'one of its spaces is a no-break space or the like: type it again'
        if is_invisible(character):
            return 'it has an invisible character, as copied text may have: type the line again'
        if plain := in_ascii(character):
            if is_wide(character):
                return f'it has {character!r}, a full-width character: write {plain!r}'
            return f'it has {character!r}: write {plain!r} in its place'
    if re.search(r'(?<!:)//|/\*', line):
        return 'a comment begins with #'
    return ''
