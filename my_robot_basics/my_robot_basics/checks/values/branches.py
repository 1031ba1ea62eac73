"""A branch of the inverse kinematics in a response of `/solve_ik`, and what is wrong with it."""

import math
from collections.abc import Sequence

from geometry_msgs.msg import Point

from my_robot_basics.checks.values import joints
from my_robot_basics.two_link_kinematics import inverse_kinematics

UP, DOWN = 'elbow_up', 'elbow_down'


def is_pose(position: Sequence[float], pose_deg: Sequence[float]) -> bool:
    """Whether a position (rad) is that pose; whole turns don't matter, as in lesson 4's log."""
    right = [math.radians(angle) for angle in pose_deg]
    return (
        len(position) == len(right)
        and all(map(math.isfinite, position))
        and all(
            abs(math.remainder(a - b, math.tau)) < joints.EXACT_RAD
            for a, b in zip(position, right, strict=True)
        )
    )


def why_off(position: Sequence[float], target: Point, branch: str, other: str) -> str:
    """Advice for a position that is not that `branch` of a target within reach."""
    right_deg = inverse_kinematics(target.x, target.y)
    if not position:
        return f'fill in both branches: response.{branch} is empty'
    if is_pose(position, right_deg[other]):
        return f'this is {other}: the two branches are swapped, or one is in both'
    if is_pose(position, inverse_kinematics(target.y, target.x)[branch]):
        return 'x and y are swapped: call inverse_kinematics(x, y) with x first'
    why = joints.why_off(list(position), right_deg[branch])
    if why == joints.CONVERT:
        return 'compare with what inverse_kinematics(x, y) returns for this target, in radians'
    return why


def in_radians(pose_deg: Sequence[float]) -> list[float]:
    """A pose in radians, to four decimals."""
    return [round(math.radians(angle), 4) for angle in pose_deg]
