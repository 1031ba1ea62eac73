"""What `/move_arm` must do, for grade cells; positions in rad, speeds in rad/s."""

import math
import random

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.arm.arm_cancels import expect_cancels, expect_late_cancel
from my_robot_basics.checks.arm.arm_moves import expect_reaches, expect_serves_on
from my_robot_basics.checks.arm.arm_refusals import (
    LIMITS_RAD,
    expect_accepts,
    expect_rejects,
)
from my_robot_basics.checks.arm.arm_reports import expect_feedback
from my_robot_basics.checks.arm.second_goals import expect_one_at_a_time
from my_robot_basics.checks.arm.watched_arm import goal

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
"""Wrong goals are once to twice this far beyond a limit, right ones at most this far within it. So
a node may round its limits to hundredths of a radian (1.57), but not to tenths (1.6)."""


def choose(numbers: random.Random, *, farther: int = 1, sign: int = 1) -> tuple[float, float]:
    """Choose a position; two positions that differ in `sign` are far apart.

    `farther` (1 or 2) is the joint whose angle is larger than the other's; `sign` is its sign.
    """
    far = round(sign * numbers.uniform(0.7, 1.4), 3)
    near = round(numbers.choice((-1, 1)) * numbers.uniform(0.15, 0.6), 3)
    return (far, near) if farther == 1 else (near, far)


def choose_wrong(numbers: random.Random) -> list[MoveArm.Goal]:
    """Choose goals that the server must reject, each with exactly one fault.

    The faults: out of range, also by a whole turn; a wrong number of angles, NaN, and a speed that
    is not above 0.
    """
    inside = choose(numbers)
    first, second = LIMITS_RAD
    beyond = BEYOND_RAD * numbers.uniform(1.0, 2.0)
    wrong = [
        goal((first + beyond, inside[1])),
        goal((inside[0], second + beyond)),
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
    below = [goal((-first - beyond, inside[1])), goal((inside[0], -second - beyond))]
    numbers.shuffle(below)
    turned = goal((inside[0] + numbers.choice((-1, 1)) * math.tau, inside[1]))
    # the hints for these are right only if the server rejects angles above the limits
    return [*wrong, *below, turned]


def choose_near_limits(numbers: random.Random) -> list[tuple[float, float]]:
    """Choose two positions just within the limits of both joints, one on each side."""
    first, second = (limit - BEYOND_RAD * numbers.uniform(0.5, 1.0) for limit in LIMITS_RAD)
    return [(first, -second), (-first, second)]
