"""What the lines of a log say about IK: the numbers in them, and which lines hold angles."""

import itertools
import re
from collections.abc import Iterable, Sequence

from my_robot_basics.checks import angles

MOST_NUMBERS = 1_000
"""Different numbers that one target may bring: with many thousands, some are always right."""
_NUMBER = re.compile(r'([±∓]|\+/[-−]|[-−]/\+)?([-−+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)')
_NAN = re.compile(r'\bnan\b', re.IGNORECASE)
_BRACES = re.compile(r'\{[A-Za-z_][^{}]*\}')
"""What an f-string without its f leaves as it is; a dict begins with a quote."""
_DECIMAL_COMMA = re.compile(r'(?<=\d),(?=\d)')
_HYPHEN = re.compile(r'(?<=\w)[-−](?=[-−+]?\d)')
"""One that parts a number from what it is called: theta1-65.92."""
_WITH_DECIMALS = re.compile(r'\d+\.\d+')
_ELBOWS_DEG = (0.0, 180.0)
"""Elbow angles of an arm that is stretched, or folded, towards a target out of reach."""


class Forms:
    """What the texts for targets in reach look like: those that hold angles, and the others."""

    def __init__(self) -> None:
        """No text was seen yet."""
        self._answers: set[str] = set()
        self._others: set[str] = set()

    def learn(self, wanted: Iterable[float], texts: Iterable[str]) -> None:
        """See all texts for one target; a form of both kinds tells nothing."""
        wanted, texts = list(wanted), {*texts}
        held = {text for text in texts if holds_any(wanted, text)}
        answers, others = ({form_of(text) for text in each} for each in (held, texts - held))
        self._answers |= answers - others
        self._others |= others - answers

    def is_answer(self, text: str) -> bool:
        """Whether a text with other numbers held angles."""
        return form_of(text) in self._answers

    def is_other(self, text: str) -> bool:
        """Whether a text with other numbers came beside the angles, and held none."""
        return form_of(text) in self._others


def numbers_of(text: str) -> list[float]:
    """All numbers in a text, in order; ±1.5 stands for two, and so do +/-1.5 and ∓1.5."""
    return [number for number, _, _ in places_of(text)]


def places_of(text: str) -> list[tuple[float, int, int]]:
    """All numbers in a text, each with where it begins and ends."""
    found = []
    for match in _NUMBER.finditer(text):
        number = float(match[2].replace('−', '-'))
        signs = {'±': (1, -1), '+': (1, -1)}.get(match[1][0], (-1, 1)) if match[1] else (1,)
        found += [(sign * number, match.start(), match.end()) for sign in signs]
    return found


def why_unreadable(wanted: Sequence[float], texts: Sequence[str]) -> str:
    """Advice for texts without the wanted angles: what stands there for a number, or ''."""
    if any(_NAN.search(text) for text in texts):
        return 'an angle is nan, which is not a number, so check how it is computed'
    if any(_BRACES.search(text) for text in texts):
        return 'put an f before the quotation mark: Python then puts the value there'
    pointed = [number for text in texts for number in numbers_of(_DECIMAL_COMMA.sub('.', text))]
    if not angles.missing(wanted, pointed):
        return 'write decimals with a point, and not with a comma'
    parted = [number for text in texts for number in numbers_of(_HYPHEN.sub(' ', text))]
    if not angles.missing(wanted, parted):
        return 'a - right before a number is its sign: put a colon or a space between'
    return ''


def form_of(text: str) -> str:
    """A text without what differs from target to target: its numbers."""
    return _NUMBER.sub('#', text)


def holds_any(wanted: Iterable[float], text: str) -> bool:
    """Whether one of the angles is among the numbers of a text."""
    return any(angles.near(angle, number) for angle in wanted for number in numbers_of(text))


def stands_for_angles(bearings_deg: Iterable[float], text: str) -> bool:
    """Whether a text has what a node without a solution gives for one: zeros, or a stretched arm.

    Zeros are two numbers or more, with decimals, and no others beside them.
    """
    found = [float(number) for number in _WITH_DECIMALS.findall(text)]
    return (len(found) > 1 and not any(found)) or has_stretched(bearings_deg, text)


def has_stretched(bearings_deg: Iterable[float], text: str) -> bool:
    """Whether a text holds a bearing as θ1, with the θ2 of a stretched or folded arm beside it.

    A bearing alone is no answer: a node that logs each target may well log it.
    """
    # 0 without decimals counts something
    found = [number for _, number in _NUMBER.findall(text) if '.' in number]
    numbers = [float(number.replace('−', '-')) for number in found]
    beside = [*itertools.pairwise(numbers), *zip(numbers[1:], numbers, strict=False)]
    return any(
        angles.near(bearing, theta1_deg) and any(angles.near(e, theta2_deg) for e in _ELBOWS_DEG)
        for bearing in bearings_deg
        for theta1_deg, theta2_deg in beside
    )
