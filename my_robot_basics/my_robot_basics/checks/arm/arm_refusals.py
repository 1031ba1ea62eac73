"""Which goals `/move_arm` accepts: those within the limits, and one at a time."""

import math

from arm_interfaces.action import MoveArm
from my_robot_basics.checks.actions.accepted_goals import expect_accepted
from my_robot_basics.checks.actions.action_ends import ActionEnds, SentGoal
from my_robot_basics.checks.actions.actions import Action
from my_robot_basics.checks.arm.arm_looks import look
from my_robot_basics.checks.arm.arm_progress import bring_in_haste, is_under_way
from my_robot_basics.checks.arm.arm_results import is_near
from my_robot_basics.checks.arm.slow_moves import wait_unless_it_crawls
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, far_rad, goal
from my_robot_basics.feedback.errors import expect, fail

LIMITS_RAD = math.radians(90.0), math.radians(120.0)
"""The largest angle of joint1 and of joint2, in either direction."""
TOO_MANY_SPEED = 0.2
"""Speed of a move during which a second goal is sent, in rad/s."""
BEFORE_PART = 0.3
"""After which part of the first move the second goal is sent."""
EARLY_PART = 0.8
"""A move that ends before this part of its time was stopped."""
MOST_TIMES, MORE_SEC = 3.0, 1.0
CLIENT_SEC = 2.0
TOLD_SEC = 1.0
"""How much later than the answer to a goal the end of the one before may be told, in s of free
time."""
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
                fail(
                    expected=f'the goal {shown} at {wrong.speed:.3g} rad/s to be rejected',
                    seen='it accepted',
                    hint=_why_wrong(wrong),
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


def expect_one_at_a_time(
    action: Action, first: Pose, second: Pose, *, start: Pose = (0.0, 0.0)
) -> None:
    """Expect the server to reject another client's goal while the arm moves to `first`.

    The move has to go on, and after it the server has to accept a goal to `second`. Positions are
    in rad. Raises CheckFailed.
    """

    def refuses(arm: WatchedArm) -> None:
        server = arm.server
        other = ActionEnds(server.watcher, server.name, server.type)
        server.watcher.spin_until(other.is_connected, timeout_sec=CLIENT_SEC)
        moving = arm.send(arm.goal(first, speed=TOO_MANY_SPEED))
        wanted_sec = far_rad(arm.start, first) / moving.goal.speed
        arm.time.let_pass(moving.is_over, seconds=BEFORE_PART * wanted_sec)
        for position in first, second:  # the arm ends there if a rejected goal leads it astray
            was_over = moving.is_over()
            too_many = server.send(goal(position, speed=TOO_MANY_SPEED), ends=other)
            # a server that blocks its other callbacks during a move answers only after it
            if moving.is_over() or (too_many.is_accepted and _came_after(moving, arm, too_many)):
                break
            _expect_none_accepted(not too_many.is_accepted)
        most_sec = MOST_TIMES * wanted_sec + MORE_SEC
        wait_unless_it_crawls(arm, moving, first, seconds=most_sec)
        expect(
            moving.is_over() or is_under_way(arm, moving, first),
            expected='the first goal to end',
            seen='it not end',
            hint='let the move end whether a second goal comes or not: end the loop of the '
            'execute callback when the arm is there',
            cause='a goal does not end',
        )
        _expect_not_led_to(second, arm, moving, first)
        is_early = arm.seconds(moving) < EARLY_PART * wanted_sec
        _expect_none_accepted(not is_early or was_over or not too_many.is_accepted)
        expect(
            not is_early,
            expected='the first goal to go on when a second one is rejected',
            seen='it ended early',
            hint=(is_early and arm.why_too_soon(moving))
            or 'leave the goal that moves the arm alone: the goal callback alone answers the '
            'second',
            cause='a second goal disturbs the first',
        )
        arm.settle()
        expect_accepted(server, goal(second, speed=TOO_MANY_SPEED))
        arm.settle()  # else a server without cancellation would still move at the next check

    look(action, refuses, start=start)


def _expect_none_accepted(is_none: bool) -> None:
    expect(
        is_none,
        expected='a goal that comes while the arm moves to be rejected',
        seen='it accepted',
        hint='remember that the arm moves, and return GoalResponse.REJECT meanwhile',
        cause='a second goal is accepted',
    )


def _came_after(moving: SentGoal, arm: WatchedArm, accepted: SentGoal) -> bool:
    """Whether the server got the accepted goal after the end of `moving`, which it told late."""
    if arm.time.is_driven:  # such a server answers during a move
        return False
    arm.server.watcher.spin_until_free(moving.is_over, free_sec=TOLD_SEC)
    stamp = accepted.answer.result().stamp
    return 0 < moving.over_ns() <= stamp.sec * 10**9 + stamp.nanosec


def _expect_not_led_to(rejected: Pose, arm: WatchedArm, moving: SentGoal, position: Pose) -> None:
    """The goal to `position` does not end at the pose of a rejected goal. Raises CheckFailed."""
    if moving.is_over():
        arm.has_result(moving)
    ends = [list(message.position) for _, message in moving.feedback()][-1:]
    if moving.result is not None:
        ends.append(list(moving.result.position))
    if any(is_near(end, rejected) and not is_near(end, position) for end in ends):
        fail(
            expected='the arm to go on to the first goal when a second one is rejected',
            seen='it go to the second goal',
            hint='remember nothing of a goal that you reject: take the goal that moves the arm '
            'from goal_handle.request, in the execute callback',
            cause='a rejected goal moves the arm',
        )


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
        'compare both angles with their limits, radians(90) and radians(120): the positions are '
        'in radians'
    )
