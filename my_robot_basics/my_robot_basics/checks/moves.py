"""What `/move_arm` is to do, for grade cells; positions in radians, speeds in radians a second."""

import math
import random

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.arm_cancels import expect_cancels, expect_late_cancel
from my_robot_basics.checks.arm_moves import expect_reaches, expect_serves_on
from my_robot_basics.checks.arm_refusals import (
    LIMITS_RAD,
    expect_accepts,
    expect_one_at_a_time,
    expect_rejects,
)
from my_robot_basics.checks.arm_reports import expect_feedback
from my_robot_basics.checks.watched_arm import goal

__all__ = [
    'choose',
    'choose_near_limits',
    'choose_wrong',
    'expect_accepts',
    'expect_cancels',
    'expect_feedback',
    'expect_late_cancel',
    'expect_one_at_a_time',
    'expect_reaches',
    'expect_rejects',
    'expect_serves_on',
    'goal',
]

BEYOND_RAD = 0.01
"""So far beyond a limit are goals that are wrong, and hardly farther, or within it, if they are
right: limits that were rounded to hundredths of a radian are right, and 1.6 is not."""


def choose(numbers: random.Random, *, farther: int = 1, sign: int = 1) -> tuple[float, float]:
    """A position with that joint on that side, so that two with different signs are far apart.

    `farther`: 1 or 2, the joint that moves more than the other one does, and not in proportion.
    """
    far = round(sign * numbers.uniform(0.7, 1.4), 3)
    near = round(numbers.choice((-1, 1)) * numbers.uniform(0.15, 0.6), 3)
    return (far, near) if farther == 1 else (near, far)


def choose_wrong(numbers: random.Random) -> list[MoveArm.Goal]:
    """Goals to be rejected: out of range, with another number of angles, with NaN, and too slow.

    Each is wrong in one way alone.
    """
    inside = choose(numbers)
    first, second = LIMITS_RAD
    beyond = BEYOND_RAD * numbers.uniform(1.0, 2.0)
    wrong = [
        *(goal((sign * (first + beyond), inside[1])) for sign in (-1, 1)),
        *(goal((inside[0], sign * (second + beyond))) for sign in (-1, 1)),
        goal(()),
        goal(inside[:1]),
        goal((*inside, numbers.uniform(-0.5, 0.5))),
        goal((math.nan, inside[1])),
        goal((inside[0], math.nan)),
        goal(inside, speed=0.0),
        goal(inside, speed=-numbers.uniform(0.1, 1.0)),
        goal(inside, speed=math.nan),
    ]
    numbers.shuffle(wrong)
    return wrong


def choose_near_limits(numbers: random.Random) -> list[tuple[float, float]]:
    """Positions just within the limits, on each side."""
    first, second = (limit - BEYOND_RAD * numbers.uniform(0.5, 1.0) for limit in LIMITS_RAD)
    return [(first, -second), (-first, second)]
