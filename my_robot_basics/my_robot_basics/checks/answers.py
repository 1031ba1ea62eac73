"""What the lines of a log say about IK: the numbers in them, and which belong together."""

import itertools
import re
from collections.abc import Iterable, Sequence

from my_robot_basics.checks import angles

MOST_NUMBERS = 1_000
"""Different numbers that one target may bring: with many thousands, some are always right."""
_NUMBER = re.compile(r'(±?)([-−+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)')
_ELBOWS_DEG = (0.0, 180.0)
"""Elbow angles of an arm that is stretched, or folded, towards a target out of reach."""

Solutions = Sequence[tuple[float, float]]
"""θ1 and θ2 of each branch, in degrees."""


def numbers_of(text: str) -> list[float]:
    """All numbers in a text, in order; ±1.5 stands for two."""
    found = []
    for sign, digits in _NUMBER.findall(text):
        number = float(digits.replace('−', '-'))
        found += [number, -number] if sign else [number]
    return found


def form_of(text: str) -> str:
    """A text without what differs from target to target: its numbers."""
    return _NUMBER.sub('#', text)


def forms_with(wanted: Iterable[float], texts: Iterable[str]) -> set[str]:
    """The forms of texts that hold one of the wanted angles, and that no other text has."""
    wanted, texts = list(wanted), list(texts)
    held = {text for text in texts if holds_any(wanted, text)}
    return {form_of(text) for text in held} - {form_of(text) for text in {*texts} - held}


def holds_any(wanted: Iterable[float], text: str) -> bool:
    """Whether one of the angles is among the numbers of a text."""
    return any(angles.near(angle, number) for angle in wanted for number in numbers_of(text))


def has_stretched(bearings_deg: Iterable[float], text: str) -> bool:
    """Whether a text holds a bearing as θ1, with the θ2 of a stretched or folded arm beside it.

    A bearing alone is no answer: who logs each target may well log that.
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


def are_mixed_up(solutions: Solutions, texts: Iterable[str]) -> bool:
    """Whether θ1 of one branch plainly stands with θ2 of the other one.

    So it does on two lines that hold one angle of each joint; and by turns, where one line holds
    all four angles, or each line one. Another number that happens to be one of the angles accuses
    nobody.
    """
    lines = [line for text in texts if (line := _labels(solutions, text))]
    pairs = [_is_wrong_pair(line) for line in lines if len(set(line)) == 2]
    if pairs.count(True) > 1 and all(pairs):
        return True
    if all(len(set(line)) == 1 for line in lines):
        lines = [[label for line in lines for label in line]]
    return any(
        _are_wrong_pairs(list(dict.fromkeys(line)))
        and _are_wrong_pairs(list(dict.fromkeys(reversed(line))))
        for line in lines
    )


def _labels(solutions: Solutions, text: str) -> list[tuple[int, int]]:
    """Branch and joint of each number that is one angle, and no other, of the solutions."""
    found = []
    for number in numbers_of(text):
        labels = [
            (branch, joint)
            for branch, pair in enumerate(solutions)
            for joint, angle in enumerate(pair)
            if angles.near(angle, number)
        ]
        found += labels if len(labels) == 1 else []
    return found


def _is_wrong_pair(labels: list[tuple[int, int]]) -> bool:
    (branch, joint), (other_branch, other_joint) = dict.fromkeys(labels)
    return branch != other_branch and joint != other_joint


def _are_wrong_pairs(labels: list[tuple[int, int]]) -> bool:
    return len(labels) == 4 and _is_wrong_pair(labels[:2]) and _is_wrong_pair(labels[2:])
