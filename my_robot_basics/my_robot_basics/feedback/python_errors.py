"""What to do about exceptions of Python and rclpy whose own words do not tell beginners."""

import re
import unicodedata

from my_robot_basics.feedback.error_words import BY_WORDS

_BY_WORDS = tuple((re.compile(words), clause) for words, clause in BY_WORDS)
_NAME = re.compile(
    r'Invalid (?P<kind>node|topic|service|)[^:]*: \w+( name)? must not contain characters other '
    r"than [^:]*:\s+'(?P<name>.*?)'(?P<caret>\s+\^)"
)
"""How rcl refuses a name, with the place of what it refuses in a line below."""
_CHARACTER = re.compile(r"invalid (?:character '(.)' \(|non-printable character )U\+")
_MARKS = {
    **dict.fromkeys('‘’‚‛′', "'"),
    **dict.fromkeys('“”„‟″', '"'),
    **dict.fromkeys('‐‑‒–—−', '-'),
    **{'。': '.', '、': ',', '【': '[', '】': ']', '《': '<', '》': '>', '×': '*', '÷': '/'},
}
"""What a word processor, or a keyboard of another language, has in place of what Python reads."""


def explained(told: str) -> str:
    """A sentence or clause that tells what was raised, with what to do behind it, if anything."""
    why = what_to_do(told)
    if found := _NAME.search(told):  # in one line its caret points nowhere
        told = told[: found.start('caret')] + told[found.end('caret') :]
    return told.rstrip('.') + why if why else told


def what_to_do(said: str) -> str:
    """A clause to put behind what was raised, such as 'AttributeError: …'; or ''."""
    if found := _CHARACTER.search(said):
        return _about_character(found[1])
    if found := _NAME.search(said):
        return _about_name(found['name'], is_node=found['kind'] == 'node')
    return next((clause for words, clause in _BY_WORDS if words.search(said)), '')


def _about_character(character: str | None) -> str:
    """Which character to type in place of this one; None is one that shows nothing."""
    if character is None:
        return ', so type that line again: it has a space of another kind, as copied text may have'
    plain = _MARKS.get(character) or unicodedata.normalize('NFKC', character)
    is_wide = unicodedata.east_asian_width(character) == 'F' and plain.isascii()
    return f', so write {plain!r} in its place' if is_wide or character in _MARKS else ''


def _about_name(name: str, *, is_node: bool) -> str:
    """Which characters a name of ROS takes in place of those that it has."""
    strange = re.search(r'\W' if is_node else r'[^\w/~{}]', name, re.ASCII)
    plain = unicodedata.normalize('NFKC', strange[0]) if strange else ''
    if strange and re.fullmatch(r'\w' if is_node else r'[\w/~{}]', plain, re.ASCII):
        return f', so write {plain!r} in place of {strange[0]!r}, a full-width character'
    if is_node:
        return ', so write a name of letters from a to z, digits and _ alone'
    return ', so write a name of letters from a to z, digits, _ and / alone'
