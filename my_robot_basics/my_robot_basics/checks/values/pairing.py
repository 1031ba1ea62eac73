"""Which θ1 and θ2 a log puts together: on one line, or with one word."""

import itertools
import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from my_robot_basics.checks.values import angles, answers

Solutions = Sequence[tuple[float, float]]
"""θ1 and θ2 of each branch, in degrees."""
Label = tuple[int, int]
"""The indices of the branch and the joint."""

_SET = re.compile(r'\{[^{}()\[\],:]*(?:,[^{}()\[\],:]*){2,}\}')
"""A set of at least three items as Python prints it, unordered. Two items may be meant as a pair,
so a set of two does not match."""
_WORD = re.compile(r'[^\W_]+')
_DECIMAL = re.compile(r'\d+\.\d+')


class _Angle(NamedTuple):
    label: Label
    number: float
    words: set[str]
    """The words beside the number on its line."""


def are_mixed_up(solutions: Solutions, texts: Iterable[str]) -> bool:
    """Whether the log clearly puts θ1 of one branch together with θ2 of the other one.

    Three forms count: a word that only these two angles have (such as a branch's name); two lines
    with one angle of each joint; and one line on which the four angles alternate. Not counted are
    words that join a right pair, a set, a sorted list, and a number that is an angle by chance.
    """
    parts = [part for text in texts for part in _SET.sub(' ', text).splitlines()]
    lines = [line for part in parts if (line := _angles(solutions, part))]
    joined = _joined_by_words(lines)
    if len(joined) > 1 or any(_is_right(pair) for pair in joined):
        return all(_is_wrong(pair) for pair in joined)
    if _is_sorted([angle for line in lines for angle in line]):
        return False
    pairs = [{angle.label for angle in line} for line in lines]
    pairs = [pair for pair in pairs if len(pair) == 2]
    if any(_is_right(pair) for pair in pairs):
        return False
    if len(pairs) > 1 and all(_is_wrong(pair) for pair in pairs):
        return True
    return any(
        not _is_sorted(line) and _are_by_turns(line) and _are_by_turns(line[::-1])
        for line in lines
    )


def _angles(solutions: Solutions, line: str) -> list[_Angle]:
    """Each number of a line that is near exactly one angle of the solutions."""
    found = []
    for number, start, end in answers.places_of(line):
        labels = [
            (branch, joint)
            for branch, pair in enumerate(solutions)
            for joint, angle in enumerate(pair)
            if angles.is_near(angle, number)
        ]
        found += [(labels[0], number, start, end)] if len(labels) == 1 else []
    ends, starts = [0, *(each[3] for each in found)], [*(each[2] for each in found), len(line)]
    words = [
        {*_WORD.findall(_DECIMAL.sub('', line[end:start]))}
        for end, start in zip(ends, starts, strict=True)
    ]
    if len(found) == 1:
        words = [words[0] | words[1]]
    elif not words[0]:
        words = words[1:]  # the words follow their number: 65.92° (θ1, up)
    return [_Angle(*each[:2], words[place]) for place, each in enumerate(found)]


def _joined_by_words(lines: Sequence[Sequence[_Angle]]) -> set[frozenset[Label]]:
    """The pairs of one angle of each joint that share a word which no other angle has."""
    called: defaultdict[str, set[Label]] = defaultdict(set)
    for angle in itertools.chain.from_iterable(lines):
        for word in angle.words:
            called[word].add(angle.label)
    return {
        frozenset(labels)
        for labels in called.values()
        if len(labels) == 2 and len({joint for _, joint in labels}) == 2
    }


def _is_wrong(pair: Iterable[Label]) -> bool:
    return all(len({*each}) == 2 for each in zip(*pair, strict=True))


def _is_right(pair: Iterable[Label]) -> bool:
    (branch, joint), (other_branch, other_joint) = pair
    return branch == other_branch and joint != other_joint


def _are_by_turns(line: Sequence[_Angle]) -> bool:
    """Whether the four angles, without repetitions, alternate between θ1 and θ2 in wrong pairs."""
    labels = list(dict.fromkeys(angle.label for angle in line))
    joints = [joint for _, joint in labels]
    return joints in ([0, 1, 0, 1], [1, 0, 1, 0]) and _is_wrong(labels[:2])


def _is_sorted(line: Sequence[_Angle]) -> bool:
    numbers = [angle.number for angle in line]
    return numbers in (sorted(numbers), sorted(numbers, reverse=True))
