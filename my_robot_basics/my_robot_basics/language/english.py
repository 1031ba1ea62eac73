"""Measure how much of a text stays English, to compare translations."""

import re

from my_robot_basics.language.templates import LETTERS

IN_BRACKETS = '{one} ({other})'
"""The template of a text with another one behind it, in brackets."""
PHRASE = 10_000
"""Added to the number of letters if a text has two English words in a row."""

_TWO_WORDS = re.compile(r'[^\W\d_]{2,} [^\W\d_]{2,}')
_NAME = re.compile(
    r'`[^`]*`|\'[^\']*\'|"[^"]*"|/[\w/]+|\w+\(.*?\)|\b[A-Z_]{2,}\b|\w*[\d_]\w*|\w+(Error|Interrupt|Exit)\b|NotRunnable'
    r'|\b(True|False|None|Hz|rad|nan|inf|JointState|Point|String|Int32)\b|\w+(/\w+)+|\b\w\b'
)
"""Names, which are the same in each language, and quoted text."""
_RAISED = re.compile(
    r'[\w.]*(Error|Exception|Interrupt|Exit)(: .*| \(line .*\))?'
    r'|[\w.]+(: .*)? \((\S+, )?line \d+, in \S+: .*\)'
    r"|Wrong parameter type, expected '\S+' got '\S+'"
    r"|(type object )?'\S+'( object)? has no attribute '\w+'",  # as rclpy logs it
    re.DOTALL,
)
"""The message of an exception, or of rclpy about a parameter's type: it stays English."""
_WITH_LINE = re.compile(r'(.+?) \(((?:\S+, )?line \d+(?:, in \S+)?(?:: .*)?)\)', re.DOTALL)
"""An exception with the line where it was raised, which the course adds in brackets."""


def letters_left(text: str) -> int:
    """Count the letters of a text that may be English words, without names and quoted text."""
    unknown = _NAME.sub('', text)
    return len(LETTERS.findall(unknown)) + PHRASE * bool(_TWO_WORDS.search(unknown))


def letters_in_names(text: str) -> float:
    """Return a small cost for text that is never translated, to prefer matches with less of it."""
    return len(LETTERS.findall(text)) / PHRASE


def is_raised(text: str) -> bool:
    """Whether a text is the message of an exception, or of rclpy about a parameter's type."""
    return bool(_RAISED.fullmatch(text))


def split_line(raised: str) -> tuple[str, str]:
    """Split an exception's text from the line where it was raised, such as `line 4, in f: g(x)`.

    The line is '' if there is none.
    """
    found = _WITH_LINE.fullmatch(raised) if raised.endswith(')') else None
    return (found[1], found[2]) if found else (raised, '')
