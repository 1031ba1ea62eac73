"""Log lines of an IK node: the numbers in them, and which lines hold angles."""

import itertools
import re
from collections.abc import Iterable, Sequence

from my_robot_basics.checks.values import angles

MOST_NUMBERS = 1_000
"""How many different numbers a node may log for one target: of many thousands, some match."""
NO_ANGLES = (
    'the INFO log names branches, and no angle: inverse_kinematics returns a dict, so go through '
    'its .items(), each a branch and its two angles'
)
"""Advice if someone took the keys of that dict for its values."""
_NUMBER = re.compile(r'([±∓]|\+/[-−]|[-−]/\+)?([-−+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)')
_NAN = re.compile(r'\bnan\b', re.IGNORECASE)
_BRACES = re.compile(r'\{[A-Za-z_][^{}]*\}')
"""A `{name}` that is left in a text if an f-string lacks its f; a dict begins with a quote."""
_DECIMAL_COMMA = re.compile(r'(?<=\d),(?=\d)')
_HYPHEN = re.compile(r'(?<=\w)[-−](?=[-−+]?\d)')
"""A hyphen between a name and its number, as in theta1-65.92."""
_WITH_DECIMALS = re.compile(r'\d+\.\d+')
MOST_PAIRS = 200
"""How many pairs of numbers `hold_both_branches` compares with each other at most."""
MIRRORED_DEG = 0.02
"""How far the sum of two logged angles may be from twice the bearing: each is rounded."""
_ELBOWS_DEG = (0.0, 180.0)
"""θ2 of a stretched and of a folded arm, which a node may compute for a target out of reach."""


class Forms:
    """The forms of the texts for targets in reach: those with angles, and the others."""

    def __init__(self) -> None:
        """Start without any form."""
        self._answers: set[str] = set()
        self._others: set[str] = set()

    def learn(self, wanted: Iterable[float], texts: Iterable[str]) -> None:
        """Learn from all texts for one target; a form both with and without angles is left out."""
        wanted, texts = list(wanted), {*texts}
        held = {text for text in texts if holds_any(wanted, text)}
        answers, others = ({form_of(text) for text in each} for each in (held, texts - held))
        self._answers |= answers - others
        self._others |= others - answers

    def is_answer(self, text: str) -> bool:
        """Whether a text of the same form held angles."""
        return form_of(text) in self._answers

    def is_other(self, text: str) -> bool:
        """Whether a text of the same form was logged beside the angles, and held none."""
        return form_of(text) in self._others


def numbers_of(text: str) -> list[float]:
    """All numbers in a text, in order; ±1.5, +/-1.5 and ∓1.5 are two numbers each."""
    return [number for number, _, _ in places_of(text)]


def places_of(text: str) -> list[tuple[float, int, int]]:
    """All numbers in a text, each with the indices of its start and end."""
    found = []
    for match in _NUMBER.finditer(text):
        number = float(match[2].replace('−', '-'))
        signs = {'±': (1, -1), '+': (1, -1)}.get(match[1][0], (-1, 1)) if match[1] else (1,)
        found += [(sign * number, match.start(), match.end()) for sign in signs]
    return found


def why_unreadable(wanted: Sequence[float], texts: Sequence[str]) -> str:
    """Advice if the angles are missing because they are not written as numbers; else ''."""
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
    if not parted and any('elbow' in text.lower() for text in texts):
        return NO_ANGLES
    return ''


def hold_both_branches(bearings_deg: Sequence[float], texts: Iterable[str]) -> bool:
    """Whether texts hold both branches of a point that is in the direction of a bearing.

    A node may compute them for the nearest point in reach. The branches of any point mirror each
    other in its bearing: the angles θ2 differ in sign, and the mean of the angles θ1 is the
    bearing.
    """
    pairs = {each for text in texts for each in itertools.pairwise(numbers_with_decimals(text))}
    return any(
        theta2 == -other2 != 0.0
        and any(angles.is_near(2 * each, theta1 + other1, MIRRORED_DEG) for each in bearings_deg)
        for (theta1, theta2), (other1, other2) in itertools.combinations(
            sorted(pairs)[:MOST_PAIRS], 2
        )
    )


def form_of(text: str) -> str:
    """A text with # for each number, which alone differs from target to target."""
    return _NUMBER.sub('#', text)


def holds_any(wanted: Iterable[float], text: str) -> bool:
    """Whether one of the angles is among the numbers of a text."""
    return any(angles.is_near(angle, number) for angle in wanted for number in numbers_of(text))


def stands_for_angles(bearings_deg: Iterable[float], text: str) -> bool:
    """Whether a text has what a node logs in place of a solution: zeros, or a stretched arm.

    Zeros count if they are two or more, with decimals, and the only numbers with decimals.
    """
    found = [float(number) for number in _WITH_DECIMALS.findall(text)]
    return (len(found) > 1 and not any(found)) or has_stretched(bearings_deg, text)


def stand_for_angles(bearings_deg: Sequence[float], texts: Sequence[str]) -> bool:
    """Whether a text stands for angles, or some texts hold both branches of another point."""
    return hold_both_branches(bearings_deg, texts) or any(
        stands_for_angles(bearings_deg, text) for text in texts
    )


def numbers_with_decimals(text: str) -> list[float]:
    """The numbers in a text that are written with decimals: a 0 without may count something."""
    found = [number for _, number in _NUMBER.findall(text) if '.' in number]
    return [float(number.replace('−', '-')) for number in found]


def has_stretched(bearings_deg: Iterable[float], text: str) -> bool:
    """Whether a text holds a bearing as θ1, next to the θ2 of a stretched or folded arm.

    A bearing alone does not count: a node that logs each target may log its bearing, too.
    """
    numbers = numbers_with_decimals(text)
    beside = [*itertools.pairwise(numbers), *zip(numbers[1:], numbers, strict=False)]
    return any(
        angles.is_near(bearing, theta1_deg)
        and any(angles.is_near(e, theta2_deg) for e in _ELBOWS_DEG)
        for bearing in bearings_deg
        for theta1_deg, theta2_deg in beside
    )
