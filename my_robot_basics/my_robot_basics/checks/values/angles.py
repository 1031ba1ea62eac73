"""Angles among the numbers of a log: which ones are missing, and advice about that."""

import math
from collections.abc import Sequence

WITHIN_DEG = 0.01
"""How far off a logged angle may be."""
ROUNDED_DEG = 0.5
"""How far off an angle is at most if rounded to whole degrees, or to hundredths of a radian."""
DECIMALS = 'log the angles with two decimals or more'
ONE_LATE = 'each answer is one target late: use the point that the callback is given, at once'
EARLIER = 'these are the angles of an earlier target: use the point that the callback is given'
AGAIN = 'answer each target, also one that is equal to the target before'
HOW = '(print(…) does not reach the log, nor does a logger of another name)'
WARN_ONLY = 'warn only when inverse_kinematics(x, y) raises ValueError'
INFO_FOR_ANGLES = 'log angles with self.get_logger().info(…), and ' + WARN_ONLY
NEEDS_WARN = 'a target out of reach needs the level WARN: self.get_logger().warning(…)'
WARN_EACH = (
    'log a warning for each target out of reach, whether it is too far away or too near: another'
    ' one had a warning'
)
CATCH = f'catch ValueError each time and log it with self.get_logger().warning(…) {HOW}'
IN_REACH = (
    '; for a target in reach it does not, so give it x and y alone, and keep other lines out of'
    ' that `try`'
)
"""Added to the advice when to warn, if a node only warned: it may catch another ValueError."""


def is_near(angle_deg: float, number: float, within_deg: float = WITHIN_DEG) -> bool:
    """Whether a number is that angle, in degrees; a difference of whole turns does not count."""
    off = (angle_deg - number + 180.0) % 360.0 - 180.0
    # a rounded number may be off by exactly the limit: leave room for floating-point errors
    return abs(off) <= within_deg + 1e-9


def missing(
    wanted: Sequence[float], numbers: Sequence[float], within_deg: float = WITHIN_DEG
) -> list[float]:
    """The wanted angles that are not among the numbers."""
    return [a for a in wanted if not any(is_near(a, n, within_deg) for n in numbers)]


def what_to_try(wanted: Sequence[float], numbers: Sequence[float]) -> str:
    """Advice for a log that lacks some of the wanted angles, from the numbers that it has instead.

    It names the cause, but never an angle.
    """
    if not numbers:
        return f'log every solution for each target, with self.get_logger().info(…) {HOW}'
    if not missing(wanted, numbers, ROUNDED_DEG):
        close = [n for n in numbers if any(is_near(a, n, ROUNDED_DEG) for a in wanted)]
        off = [n for n in close if not any(is_near(a, n) for a in wanted)]
        # of a few digits in all, as {:.4g} has them, small angles are right
        if all(number == round(number, 1) for number in off):
            return DECIMALS
        return 'the angles are close, and not right: add nothing to them, and round nothing before'
    if not missing([math.trunc(angle) for angle in wanted], numbers):
        return DECIMALS
    if not missing(wanted, [math.degrees(number) for number in numbers], ROUNDED_DEG):
        return 'these are radians, so log them with math.degrees(…)'
    if not missing(wanted, [math.radians(number) for number in numbers]):
        return 'these are degrees converted once more: log the angles without math.degrees(…)'
    absent = missing(wanted, numbers)
    if not missing([90.0 - angle for angle in absent], numbers):
        # the pose is mirrored in the line x = y, and so the two branches are swapped, too
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
