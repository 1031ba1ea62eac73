"""Joint positions in radians, each within its range."""

import math
from collections.abc import Sequence
from typing import Any

from my_robot_basics.checks import pictures
from my_robot_basics.feedback.errors import expect, fail

ANGLE_SLACK_RAD = 1e-6


def check_positions(
    messages: Sequence[Any], low: Sequence[float], high: Sequence[float], names: Sequence[str]
) -> None:
    """Fail unless each message has a position between low and high for each joint, in radians.

    With `names`, these are the joints of low and high, in whatever order a message has them.
    """
    for message in messages:
        seen = len(message.position)
        expect(
            seen == len(low),
            expected=f'{len(low)} positions in each message',
            seen=str(seen),
            hint='message.position holds one angle for each joint, in the order of the names',
        )
    poses = [_by_name(message, names) for message in messages]
    for pose in poses:
        if not _within(pose, low, high):
            _fail_position(pose, low, high, poses=poses)


def _fail_position(
    pose: Sequence[float], low: Sequence[float], high: Sequence[float], *, poses: list
) -> None:
    degrees = [[math.degrees(bound) for bound in bounds] for bounds in (low, high)]
    shown = ', '.join(f'{angle:.4g}' for angle in pose)
    picture = None
    # half a turn is the most that an angle in radians is likely to be
    largest = max(abs(angle) for each in poses for angle in each)
    if largest > math.pi and all(_within(each, *degrees) for each in poses):
        seen, hint = f'({shown}), which looks like degrees', 'convert with math.radians(…)'
        picture = pictures.misread(pose)
    else:
        seen = f'({shown})'
        hint = 'keep each joint within its range, and each position beside its own name'
    bounds = ', '.join(f'{a:.4g} to {b:.4g}' for a, b in zip(low, high, strict=True))
    expected = f'positions in radians ({bounds})'
    fail(expected=expected, seen=seen, hint=hint, picture=picture)


def _within(pose: Sequence[float], low: Sequence[float], high: Sequence[float]) -> bool:
    # a NaN is within nothing
    slack = ANGLE_SLACK_RAD
    return all(a - slack <= x <= b + slack for x, a, b in zip(pose, low, high, strict=True))


def _by_name(message: Any, names: Sequence[str]) -> tuple[float, ...]:
    position = tuple(message.position)
    if not names or sorted(message.name) != sorted(names) or len(position) != len(names):
        return position
    return tuple(position[list(message.name).index(name)] for name in names)
