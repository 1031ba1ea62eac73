"""The joints of a JointState by name, and what to say where they are not as asked for."""

import math
import random
from collections.abc import Sequence
from typing import Any

from sensor_msgs.msg import JointState

from my_robot_basics.feedback.errors import expect

EXACT_RAD = 2e-4
MOST_JOINTS = 100
"""What has more is no pose of an arm, and is not looked at."""
CLOSE_RAD = 0.02
"""A pose that was rounded to two decimals is no further off."""
OTHER_TYPE = 'publish a JointState there: compare the message type in create_publisher(…)'
SWAPPED = 'the joints are swapped: θ1 belongs to joint1, and comes first'
CONVERT = 'convert both angles with radians(), θ1 for joint1, θ2 for joint2'
"""What to try where nobody knows what a pose is instead. …"""
CONVERT_EACH = (
    'other angles came out right: convert each with radians(), whatever its sign or size, and keep'
    ' nothing of those before'
)
"""… And where another pose was right."""


def make(numbers: random.Random, *names: str) -> JointState:
    """Return a message with these joints, each at a random angle within ±1.5 rad."""
    return JointState(name=[*names], position=[numbers.uniform(-1.5, 1.5) for _ in names])


def pose(message: Any) -> dict[str, float]:
    """Return each joint's position, to four decimals.

    Nothing where names and positions differ in number, a name is there twice, there are too many,
    or it is no JointState.
    """
    if not isinstance(message, JointState):
        return {}
    if len(message.name) != len(message.position) or len(message.name) > MOST_JOINTS:
        return {}
    if len({*message.name}) != len(message.name):
        return {}
    pairs = zip(message.name, message.position, strict=True)
    return {name: round(position, 4) for name, position in pairs}


def agree(seen: dict[str, float], right: dict[str, float], within_rad: float = EXACT_RAD) -> bool:
    """Whether each joint of `right` is there, and where it should be."""
    return all(
        joint in seen and abs(seen[joint] - position) < within_rad
        for joint, position in right.items()
    )


def shown(message: Any) -> dict[str, float] | str:
    """What the feedback shows of a message."""
    if not isinstance(message, JointState):
        return f'a message of the type {type(message).__name__}'
    names, positions = len(message.name), len(message.position)
    return pose(message) or f'{positions} positions with {names} names'


def in_radians(pose_deg: Sequence[float]) -> dict[str, float]:
    """The position of joint1 and joint2 for a pose in degrees, to four decimals."""
    return {
        f'joint{number}': round(math.radians(angle), 4)
        for number, angle in enumerate(pose_deg, start=1)
    }


def expect_radians(
    position: Sequence[float], pose_deg: Sequence[float], *, others_right: bool = False
) -> None:
    """The positions are these angles in radians, in this order. Raises CheckFailed.

    `others_right`: whether another pose has come out as it should.
    """
    right = list(in_radians(pose_deg).values())
    expect(
        _are_near(position, [math.radians(angle) for angle in pose_deg]),  # both not rounded
        expected=f'{right} rad for {tuple(pose_deg)} degrees',
        seen=f'{[round(each, 4) for each in position]}',
        hint=why_off(list(position), pose_deg, others_right=others_right),
    )


def why_wrong(message: Any, pose_deg: Sequence[float], *, others_right: bool = False) -> str:
    """Advice for a message that is not that pose; it names the cause, and none of the angles.

    `others_right`: whether another pose has come out as it should.
    """
    if not isinstance(message, JointState):
        return OTHER_TYPE
    seen, right = pose(message), in_radians(pose_deg)
    if len(message.name) == len(right) and _adds_to_others(list(message.position), pose_deg):
        return why_off(list(message.position), pose_deg, others_right=others_right)
    if seen.keys() != right.keys():
        return f'give each message two positions, and the names {" and ".join(right)}'
    return why_off([seen[name] for name in right], pose_deg, others_right=others_right)


def why_off(
    seen: Sequence[float], pose_deg: Sequence[float], *, others_right: bool = False
) -> str:
    """Advice for positions in radians that are not this pose, by what they are instead."""
    right = [math.radians(angle) for angle in pose_deg]
    if len(seen) > len(right) and len(seen) % len(right) == 0:
        return 'it adds to the positions of the call before: make a new message and list each time'
    if len(seen) != len(right):
        return 'put one position for each joint into the list'
    if not all(map(math.isfinite, seen)):
        return 'a position is not a finite number (nan or inf), so check how it is computed'
    causes = {
        'these are degrees: convert both with radians()': pose_deg,
        SWAPPED: right[::-1],
        'radians() is called twice': [math.radians(angle) for angle in right],
        'degrees() converts the other way: call radians()': [math.degrees(a) for a in pose_deg],
        'joint2 is still in degrees: convert both with radians()': [right[0], pose_deg[1]],
        'joint1 is still in degrees: convert both with radians()': [pose_deg[0], right[1]],
        'the sign of joint1 is wrong': [-right[0], right[1]],
        'the sign of joint2 is wrong': [right[0], -right[1]],
        'both signs are wrong': [-angle for angle in right],
        'joint2 holds θ1, too': [right[0], right[0]],
        'joint1 holds θ2, too': [right[1], right[1]],
        'joint2 holds θ1 + θ2, and not θ2 alone': [right[0], sum(right)],
        '180 degrees are pi radians, and not 360: call radians()': [each / 2 for each in right],
        '180 degrees are pi radians, and not 2 pi: call radians()': [2 * each for each in right],
        'these are parts of half a turn: call radians()': [each / 180 for each in pose_deg],
        'these are parts of a whole turn: call radians()': [each / 360 for each in pose_deg],
    }
    found = [cause for cause, wrong in causes.items() if _are_near(seen, wrong)]
    to_one_decimal = [round(angle, 1) for angle in right]
    if not found and (_are_near(seen, right, CLOSE_RAD) or _are_near(seen, to_one_decimal)):
        return 'close: use radians() itself, and do not round'
    off = [(a - b) % math.tau for a, b in zip(seen, right, strict=True)]
    if not found and _are_near([min(each, math.tau - each) for each in off], [0.0] * len(off)):
        return 'it is a whole turn too far: convert the angle as it is given, without % 360'
    return next(iter(found), CONVERT_EACH if others_right else CONVERT)


def _adds_to_others(position: Sequence[float], pose_deg: Sequence[float]) -> bool:
    """Whether this pose stands behind others: neither zeros nor its own angles, in any unit."""
    right = [math.radians(angle) for angle in pose_deg]
    others, last = position[: -len(right)], position[-len(right) :]
    own = 0.0, *right, *pose_deg
    return (
        0 < len(others) <= MOST_JOINTS
        and len(others) % len(right) == 0
        and _are_near(last, right)
        and not any(_are_near([other], [angle]) for other in others for angle in own)
    )


def _are_near(
    seen: Sequence[float], wanted: Sequence[float], within_rad: float = EXACT_RAD
) -> bool:
    # a NaN is near nothing
    return len(seen) == len(wanted) and all(
        abs(a - b) < within_rad for a, b in zip(seen, wanted, strict=True)
    )
