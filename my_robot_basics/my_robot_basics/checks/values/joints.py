"""The joints of a JointState by name, and advice if they are not as they should be."""

import math
import random
from collections.abc import Sequence
from typing import Any

from sensor_msgs.msg import JointState

from my_robot_basics.feedback.errors import expect

EXACT_RAD = 2e-4
"""How far off a position may be: some are rounded to four decimals."""
ROUNDED_RAD, EXACT_PART = 1.2e-4, 1e-4
"""The same for a large one: both may be rounded, and 57.3 for 180 / π is exact enough, for each
angle alike. Otherwise hidden inputs would decide who is right."""
MOST_JOINTS = 100
"""A message with more joints is not a pose of the arm, and is not looked at."""
CLOSE_RAD = 0.02
"""A pose that is no farther off than this may have been rounded to two decimals."""
OTHER_TYPE = 'publish a JointState there: compare the message type in create_publisher(…)'
SWAPPED = 'the joints are swapped: θ1 belongs to joint1, and comes first'
SIGNS = {
    'the sign of joint1 is wrong': (-1.0, 1.0),
    'the sign of joint2 is wrong': (1.0, -1.0),
    'both signs are wrong': (-1.0, -1.0),
}
"""Advice for a mirrored pose, with the factors that mirror it."""
CONVERT = 'convert both angles with radians(), θ1 for joint1, θ2 for joint2'
"""Advice for a pose that does not look like a known mistake."""
NO_POSITIONS = (
    'put one position for each joint into the field `position`: JointState(…) ignores arguments '
    'of any other name, such as `positions`'
)
"""Advice for an empty list: rclpy checks the names of arguments only if it is told to."""
NO_NAMES = (
    'put the names of the joints into the field `name`: JointState(…) ignores arguments of any '
    'other name, such as `names`'
)
CONVERT_EACH = (
    'other angles came out right: convert each with radians(), whatever its sign or size, and keep'
    ' nothing of those before'
)
"""The same if another pose was right."""


def make(numbers: random.Random, *names: str) -> JointState:
    """Return a message with these joints, each at a random angle within ±1.5 rad."""
    return JointState(name=[*names], position=[numbers.uniform(-1.5, 1.5) for _ in names])


def pose(message: Any) -> dict[str, float]:
    """Return each joint's position, to four decimals.

    Return {} if it is not a JointState, the numbers of names and positions differ, a name comes
    twice, or there are more than MOST_JOINTS.
    """
    if not isinstance(message, JointState):
        return {}
    if len(message.name) != len(message.position) or len(message.name) > MOST_JOINTS:
        return {}
    if len({*message.name}) != len(message.name):
        return {}
    pairs = zip(message.name, message.position, strict=True)
    return {name: round(position, 4) for name, position in pairs}


def agree(seen: dict[str, float], right: dict[str, float]) -> bool:
    """Whether `seen` has each joint of `right`, at the same position up to small errors."""
    return all(
        joint in seen
        and abs(seen[joint] - at) < max(EXACT_RAD, ROUNDED_RAD + EXACT_PART * abs(at))
        for joint, at in right.items()
    )


def shown(message: Any) -> dict[str, float] | str:
    """What the feedback page shows of a message."""
    if not isinstance(message, JointState):
        return f'a message of the type {type(message).__name__}'
    names, positions = len(message.name), len(message.position)
    return pose(message) or f'{positions} positions with {names} names'


def in_radians(pose_deg: Sequence[float]) -> dict[str, float]:
    """The positions of joint1 and joint2, in rad to four decimals, for a pose in degrees."""
    return {
        f'joint{number}': round(math.radians(angle), 4)
        for number, angle in enumerate(pose_deg, start=1)
    }


def expect_radians(
    position: Sequence[float], pose_deg: Sequence[float], *, others_right: bool = False
) -> None:
    """Expect the positions to be the angles of `pose_deg` in radians, in this order.

    `others_right`: whether the result for another pose was right. Raises CheckFailed.
    """
    right = list(in_radians(pose_deg).values())
    expect(
        _are_near(position, [math.radians(angle) for angle in pose_deg]),  # both unrounded
        expected=f'{right} rad for {tuple(pose_deg)} degrees',
        seen=f'{[round(each, 4) for each in position]}',
        hint=why_off(list(position), pose_deg, others_right=others_right),
    )


def why_wrong(message: Any, pose_deg: Sequence[float], *, others_right: bool = False) -> str:
    """Advice for a message that is not that pose; it names the cause, but never an angle.

    `others_right`: whether the result for another pose was right.
    """
    if not isinstance(message, JointState):
        return OTHER_TYPE
    seen, right = pose(message), in_radians(pose_deg)
    if len(message.name) == len(right) and _adds_to_others(list(message.position), pose_deg):
        return why_off(list(message.position), pose_deg, others_right=others_right)
    if seen.keys() != right.keys():
        if len(right) < len(message.name) == len(message.position) and {*message.name} == {*right}:
            return why_names(message.name, [*right])
        return f'give each message two positions, and the names {" and ".join(right)}'
    return why_off([seen[name] for name in right], pose_deg, others_right=others_right)


def why_off(
    seen: Sequence[float], pose_deg: Sequence[float], *, others_right: bool = False
) -> str:
    """Advice for positions that should be this pose in radians, by the mistake they look like."""
    right = [math.radians(angle) for angle in pose_deg]
    if len(seen) > len(right) and len(seen) % len(right) == 0:
        return 'it adds to the positions of the call before: make a new message and list each time'
    if not seen:
        return NO_POSITIONS
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
        **{
            why: [a * b for a, b in zip(signs, right, strict=True)] for why, signs in SIGNS.items()
        },
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
        return 'it is a whole turn too far: convert the angle as it is given, without a modulo (%)'
    return next(iter(found), CONVERT_EACH if others_right else CONVERT)


def why_names(seen: Sequence[str], names: Sequence[str]) -> str:
    """Advice for names that are not these; several rounds of these come from one list."""
    if not seen:
        return NO_NAMES
    if len(seen) > len(names) and set(seen) == set(names):
        return 'it adds to the names of the call before: make a new message and list each time'
    return 'message.name is a list of the joint names of the URDF, letter for letter'


def tells_to_convert(advice: str) -> bool:
    """Whether advice of `why_off` is to convert, which does not help if the angles are in rad."""
    return 'radians()' in advice


def _adds_to_others(position: Sequence[float], pose_deg: Sequence[float]) -> bool:
    """Whether other poses precede this one: neither zeros nor its own angles, in any unit."""
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
    # False for NaN: each comparison with NaN is False
    return len(seen) == len(wanted) and all(
        abs(a - b) < within_rad for a, b in zip(seen, wanted, strict=True)
    )
