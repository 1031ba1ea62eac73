"""Hints for exceptions of Python and rclpy whose messages do not help beginners."""

import re
import unicodedata
from functools import cache

from my_robot_basics.feedback.action_errors import OF_ACTIONS
from my_robot_basics.feedback.call_errors import OF_CALLS
from my_robot_basics.feedback.characters import in_ascii
from my_robot_basics.feedback.error_words import BY_WORDS
from my_robot_basics.feedback.future_errors import OF_FUTURES
from my_robot_basics.feedback.hidden import student_text, without_marks
from my_robot_basics.feedback.message_errors import OF_MESSAGES
from my_robot_basics.feedback.missing_attributes import hint_for_missing, hint_for_misspelt
from my_robot_basics.feedback.moved_names import MOVED
from my_robot_basics.feedback.syntax_errors import OF_SYNTAX
from my_robot_basics.feedback.value_errors import OF_VALUES

_ALL_CASES = (
    *(OF_SYNTAX, OF_ACTIONS, OF_FUTURES, OF_MESSAGES),
    *(BY_WORDS, MOVED, OF_CALLS, OF_VALUES),
)
_NAME = re.compile(
    r'Invalid (?P<kind>node|topic|service|)[^:]*: \w+( name)? must not contain characters other '
    r"than [^:]*:\s+'(?P<name>.*?)'(?P<caret>\s+\^)"
)
"""rcl's message about an invalid name, with a caret under the wrong character one line below."""
_CHARACTER = re.compile(r"invalid (?:character '(.)' \(|non-printable character )U\+")
_SIGNS = {'≤': '<=', '≥': '>=', '≠': '!=', '²': '**2', '³': '**3', '·': '*', '⋅': '*'}
"""Signs of formulas, and what Python has for them."""


def with_hint(told: str) -> str:
    """Return a text that names an exception, with a hint appended if there is one."""
    why = hint_for_exception(told)
    if found := _NAME.search(told):  # in a single line, the caret points nowhere
        told = told[: found.start('caret')] + told[found.end('caret') :]
    return told.rstrip('.') + why if why else told


def hint_for_exception(said: str) -> str:
    """Return a hint to append to an exception's text, such as 'AttributeError: …'; or ''."""
    said = without_marks(said)
    if found := _CHARACTER.search(said):
        return _about_character(found[1])
    if found := _NAME.search(said):
        return _about_name(found['name'], is_node=found['kind'] == 'node')
    if misspelt := hint_for_misspelt(said):
        return misspelt
    by_words = (clause for words, clause in _compile_cases() if words.search(said))
    return next(by_words, '') or hint_for_missing(said)


@cache
def _compile_cases() -> tuple[tuple[re.Pattern[str], str], ...]:
    """Return all cases, compiled: not at import, because it takes longer than all the rest."""
    return tuple((re.compile(words), clause) for cases in _ALL_CASES for words, clause in cases)


def _about_character(character: str | None) -> str:
    """Return which character to type in place of this one; None is an invisible one."""
    if character is None:
        return ', so type that line again: it has a space of another kind, as copied text may have'
    ascii_text = _SIGNS.get(character) or in_ascii(character)
    plain = student_text(repr(ascii_text)) if ascii_text else ''
    return f', so write {plain} in its place' if plain else ''


def _about_name(name: str, *, is_node: bool) -> str:
    """Return a hint about the characters that a ROS name may have."""
    found = re.search(r'\W' if is_node else r'[^\w/~{}]', name, re.ASCII)
    plain = unicodedata.normalize('NFKC', found[0]) if found else ''
    if found and re.fullmatch(r'\w' if is_node else r'[\w/~{}]', plain, re.ASCII):
        plain, strange = student_text(repr(plain)), student_text(repr(found[0]))
        return f', so write {plain} in place of {strange}, a full-width character'
    if is_node:
        return ', so write a name of letters from a to z, digits and _ alone'
    return ', so write a name of letters from a to z, digits, _ and / alone'
