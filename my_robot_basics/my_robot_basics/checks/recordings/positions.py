"""Joint positions in radians, each within its range."""

import itertools
import math
from collections.abc import Sequence
from typing import Any

from my_robot_basics.checks.recordings import pictures
from my_robot_basics.checks.values import joints
from my_robot_basics.feedback.errors import expect, fail

ANGLE_SLACK_RAD = 1e-3
"""How far a position may exceed its range: π / 2 is often written as 1.571."""
WHOLE_TURN_DEG = 360.0
FEWEST_STEPS = 8
"""This many steps in one direction, and no other, are no coincidence."""


def check_positions(
    messages: Sequence[Any], low: Sequence[float], high: Sequence[float], names: Sequence[str]
) -> None:
    """Fail unless each message has a position between low and high for each joint, in radians.

    `names` are the joints of `low` and `high`; a message may have them in any order.
    """
    for message in messages:
        seen = len(message.position)
        expect(
            seen == len(low),
            expected=f'{len(low)} positions in each message',
            seen=str(seen),
            hint='message.position holds one angle for each joint, in the order of the names'
            if seen
            else joints.NO_POSITIONS,
        )
    poses = [_by_name(message, names) for message in messages]
    for pose in poses:
        if not _within(pose, low, high):
            _fail_position(pose, low, high, poses=poses)


def _fail_position(
    pose: Sequence[float], low: Sequence[float], high: Sequence[float], *, poses: list
) -> None:
    degrees = [[math.degrees(bound) for bound in bounds] for bounds in (low, high)]
    of_degrees = [[math.degrees(bound) for bound in bounds] for bounds in degrees]
    shown = ', '.join(f'{angle:.4g}' for angle in pose)
    picture = None
    # an angle in radians is rarely above 2π, and one in degrees rarely above 360
    largest = max(abs(angle) for each in poses for angle in each)
    if _grow(poses, low, high):
        seen = f'({shown}), further out with each message'
        hint = (
            'turn back at the end of the range, or use math.sin; and convert with'
            ' math.radians(…) what is in degrees'
        )
    elif largest > math.tau and all(_within(each, *degrees) for each in poses):
        seen, hint = f'({shown}), which looks like degrees', 'convert with math.radians(…)'
        picture = pictures.draw_misread_arm(pose)
    elif largest > WHOLE_TURN_DEG and all(_within(each, *of_degrees) for each in poses):
        seen = f'({shown}), too large for degrees, too'
        hint = 'degrees() converts the other way: call radians()'
    else:
        seen = f'({shown})'
        hint = 'keep each joint within its range, and each position beside its own name'
    bounds = ', '.join(f'{a:.4g} to {b:.4g}' for a, b in zip(low, high, strict=True))
    expected = f'positions in radians ({bounds})'
    fail(expected=expected, seen=seen, hint=hint, picture=picture)


def _grow(poses: Sequence[Sequence[float]], low: Sequence[float], high: Sequence[float]) -> bool:
    """Whether a joint that leaves its range moves in the same direction in every message."""
    joints = zip(*poses, low, high, strict=True)
    for *angles, lowest, highest in joints:
        steps = [after - angle for angle, after in itertools.pairwise(angles)]
        is_one_way = all(step > 0.0 for step in steps) or all(step < 0.0 for step in steps)
        is_out = min(angles) < lowest - ANGLE_SLACK_RAD or max(angles) > highest + ANGLE_SLACK_RAD
        if len(steps) >= FEWEST_STEPS and is_one_way and is_out:
            return True
    return False


def _within(pose: Sequence[float], low: Sequence[float], high: Sequence[float]) -> bool:
    # NaN fails both comparisons, so it is not within the range
    slack = ANGLE_SLACK_RAD
    return all(a - slack <= x <= b + slack for x, a, b in zip(pose, low, high, strict=True))


def _by_name(message: Any, names: Sequence[str]) -> tuple[float, ...]:
    position = tuple(message.position)
    if not names or sorted(message.name) != sorted(names) or len(position) != len(names):
        return position
    return tuple(position[list(message.name).index(name)] for name in names)
