"""How much of a text stays English."""

import re

from my_robot_basics.language.templates import LETTERS

PHRASE = 10_000
"""What counts for several words in English, one behind the other, over that for their letters."""

_TWO_WORDS = re.compile(r'[^\W\d_]{2,} [^\W\d_]{2,}')
_NAME = re.compile(
    r'`[^`]*`|\'[^\']*\'|"[^"]*"|/[\w/]+|\w+\(.*?\)|\b[A-Z_]{2,}\b|\w*[\d_]\w*|\w+(Error|Interrupt|Exit)\b|NotRunnable'
    r'|\b(True|False|None|Hz|rad|nan|inf|JointState|Point|String|Int32)\b|\w+(/\w+)+|\b\w\b'
)
"""What is a name in each language, or quoted."""
_RAISED = re.compile(
    r'[\w.]*(Error|Exception|Interrupt|Exit)(: .*| \(line .*\))?'
    r"|Wrong parameter type, expected '\S+' got '\S+'",
    re.DOTALL,
)
"""What Python says of an exception, or rclpy of a parameter: it stays in English."""


def letters_left(text: str) -> int:
    """Count the letters of a text that may be words: names and what is quoted are none."""
    unknown = _NAME.sub('', text)
    return len(LETTERS.findall(unknown)) + PHRASE * bool(_TWO_WORDS.search(unknown))


def letters_in_names(text: str) -> float:
    """Count the letters of what nobody translates: of two ways, the one with fewer is taken."""
    return len(LETTERS.findall(text)) / PHRASE


def is_raised(text: str) -> bool:
    """Whether Python, or rclpy, says this of what was wrong."""
    return bool(_RAISED.fullmatch(text))
