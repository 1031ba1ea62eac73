"""Measure how much of a text stays English, to compare translations."""

import re

from my_robot_basics.language.templates import LETTERS

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
    r"|Wrong parameter type, expected '\S+' got '\S+'",
    re.DOTALL,
)
"""The message of an exception, or of rclpy about a parameter's type: it stays English."""


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
