"""Which goals `/move_arm` accepts: those within the limits."""

import math

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.actions.actions import Action
from my_robot_basics.checks.arm.arm_looks import look
from my_robot_basics.checks.arm.arm_progress import bring_in_haste
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, goal
from my_robot_basics.feedback.errors import expect, fail

_UNASKED = '; without goal_callback in ActionServer(…), rclpy accepts every goal'
LIMITS_RAD = math.radians(90.0), math.radians(120.0)
"""The largest angle of joint1 and of joint2, in either direction."""
SLOW_SPEED, SLOW_RAD = 0.005, 0.01
"""A speed that has to be accepted, in rad/s, and the way of that goal: the move takes 2 s."""


def expect_rejects(action: Action, *goals: MoveArm.Goal) -> None:
    """Expect each goal to be rejected. Raises CheckFailed."""
    with action.opened() as server:
        for wrong in goals:
            sent = server.send(wrong)
            if sent.is_accepted:
                server.ends.cancel(sent)
                shown = [round(each, 3) for each in wrong.position]
                has_rejected_none = wrong is goals[0]
                fail(
                    expected=f'the goal {shown} at {wrong.speed:.3g} rad/s to be rejected',
                    seen='it accepted',
                    hint=_why_wrong(wrong) + (_UNASKED if has_rejected_none else ''),
                    cause=f'{_what_is_wrong(wrong)} is accepted',
                )


def expect_accepts(action: Action, *positions: Pose) -> None:
    """Expect goals to these positions (rad) to be accepted, in this order, and then a slow one.

    Raises CheckFailed.
    """

    def accepts(arm: WatchedArm) -> None:
        for position in positions:
            bring_in_haste(arm, position)
        first, *others = arm.start
        near = [first - math.copysign(SLOW_RAD, first), *others]
        expect(
            arm.server.send(goal(near, speed=SLOW_SPEED)).is_accepted,
            expected=f'a goal at {SLOW_SPEED:g} rad/s to be accepted',
            seen='it rejected',
            hint='every speed above 0 is allowed: check goal.speed > 0, and nothing else',
            cause='a goal with a low speed is rejected',
        )

    look(action, accepts, start=(0.0, 0.0))


def _what_is_wrong(wrong: MoveArm.Goal) -> str:
    if len(wrong.position) != len(LIMITS_RAD):
        return 'a goal with another number of angles'
    if not all(map(math.isfinite, [*wrong.position, wrong.speed])):
        return 'a goal with NaN'
    return 'a goal without a positive speed' if wrong.speed <= 0.0 else 'a goal out of range'


def _why_wrong(wrong: MoveArm.Goal) -> str:
    if len(wrong.position) != len(LIMITS_RAD):
        return 'a goal has two angles: look at len(goal.position)'
    if not all(map(math.isfinite, [*wrong.position, wrong.speed])):
        return (
            'every comparison with NaN is False, so check for what is allowed, such as '
            '`goal.speed > 0`'
        )
    if wrong.speed <= 0.0:
        return 'reject a goal whose speed is not above 0'
    if all(
        abs(math.remainder(angle, math.tau)) <= limit
        for angle, limit in zip(wrong.position, LIMITS_RAD, strict=True)
    ):
        return (
            'compare each angle as the goal has it: one that is a whole turn away is out of '
            'range, too'
        )
    if all(angle <= limit for angle, limit in zip(wrong.position, LIMITS_RAD, strict=True)):
        return (
            'there is a limit on both sides: compare the size of each angle, abs(…), with its '
            'limit in radians'
        )
    return (
        'compare both angles with their limits in radians, `pi / 2` and `2 * pi / 3`: the '
        'positions are in radians'
    )
