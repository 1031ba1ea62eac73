"""Angles among the numbers of a log: which are there, and what to say where some are missing."""

import math
from collections.abc import Sequence

WITHIN_DEG = 0.01
ROUNDED_DEG = 0.5
"""Angles that were rounded are no further off, in whole degrees or in hundredths of a radian."""
DECIMALS = 'log the angles with two decimals or more'
ONE_LATE = 'each answer is one target late: use the point that the callback is given, at once'
EARLIER = 'these are the angles of an earlier target: use the point that the callback is given'
AGAIN = 'answer each target, also one that is equal to the target before'
HOW = '(print(…) does not reach the log, nor does a logger of another name)'

IN_REACH = (
    '; for a target in reach it does not, so give it x and y alone, and keep other lines out of'
    ' that `try`'
)
"""Behind when to warn, where a node has only warned: another ValueError may have been caught."""


def near(angle_deg: float, number: float, within_deg: float = WITHIN_DEG) -> bool:
    """Whether a number is that angle, whole turns aside."""
    off = (angle_deg - number + 180.0) % 360.0 - 180.0
    # a text of two decimals is no better than half a unit of the last one
    return abs(off) <= within_deg + 1e-9


def missing(
    wanted: Sequence[float], numbers: Sequence[float], within_deg: float = WITHIN_DEG
) -> list[float]:
    """Those of the wanted angles that no number is near to."""
    return [a for a in wanted if not any(near(a, n, within_deg) for n in numbers)]


def what_to_try(wanted: Sequence[float], numbers: Sequence[float]) -> str:
    """Advice for a log that lacks some of the wanted angles, by what it holds instead.

    It names the cause, and none of the angles.
    """
    if not numbers:
        return f'log every solution for each target, with self.get_logger().info(…) {HOW}'
    if not missing(wanted, numbers, ROUNDED_DEG):
        close = [n for n in numbers if any(near(a, n, ROUNDED_DEG) for a in wanted)]
        if all(number == round(number, 1) for number in close):
            return DECIMALS
        return 'the angles are close, and not right: add nothing to them, and round nothing before'
    if not missing([math.trunc(angle) for angle in wanted], numbers):
        return DECIMALS
    if not missing(wanted, [math.degrees(number) for number in numbers], ROUNDED_DEG):
        return 'these are radians, so log them with math.degrees(…)'
    absent = missing(wanted, numbers)
    if not missing([90.0 - angle for angle in absent], numbers):
        # mirrored in the line x = y, and the branches change places with it
        return 'x and y are swapped: call inverse_kinematics(x, y) with x first'
    if not missing([angle + 180.0 for angle in absent], numbers):
        if not set(absent) & set(wanted[::2]):
            return 'θ2 is half a turn off: it is 0° when the arm is stretched, and not 180°'
        return 'θ1 is half a turn off: atan2(y, x) knows the quadrant, atan(y / x) does not'
    if not missing([-angle for angle in wanted], numbers):
        return 'all angles are mirrored, so look at the sign of y'
    if len(absent) < len(wanted):
        return _what_is_absent(wanted, absent)
    return 'compare with what inverse_kinematics(x, y) returns for this target'


def _what_is_absent(wanted: Sequence[float], absent: Sequence[float]) -> str:
    every = 'log every solution, both angles of both branches'
    if absent in (list(wanted[:2]), list(wanted[2:])):
        return f'{every}: one branch is not there'
    if absent in (list(wanted[::2]), list(wanted[1::2])):
        joint = 'θ1' if absent == list(wanted[::2]) else 'θ2'
        return f'{every}: {joint} is missing or wrong in both'
    return f'{every}: {len(absent)} of {len(wanted)} angles missing or wrong'
