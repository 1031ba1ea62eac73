"""Goals that reach `/move_arm` while the arm moves: it rejects them, and the move goes on."""

import time

from my_robot_basics.checks.actions.accepted_goals import expect_accepted
from my_robot_basics.checks.actions.action_ends import ActionEnds, SentGoal
from my_robot_basics.checks.actions.actions import Action
from my_robot_basics.checks.arm.arm_looks import look
from my_robot_basics.checks.arm.arm_progress import is_under_way
from my_robot_basics.checks.arm.arm_results import is_near
from my_robot_basics.checks.arm.slow_moves import wait_unless_it_crawls
from my_robot_basics.checks.arm.speed_hints import why_speed
from my_robot_basics.checks.arm.watched_arm import (
    EARLY_PART,
    Pose,
    WatchedArm,
    far_rad,
    goal,
)
from my_robot_basics.feedback.errors import expect, fail

TOO_MANY_SPEED = 0.2
"""Speed of a move during which a second goal is sent, in rad/s."""
BEFORE_PART = 0.3
"""After which part of the first move the second goal is sent."""
MOST_TIMES, MORE_SEC = 3.0, 1.0
CLIENT_SEC = 2.0
TOLD_SEC = 1.0
"""How much later than the answer to a goal the end of the one before may be told, in s of free
time."""
LOST_NS = 20_000_000
"""How much later an end may be told if its message is lost: the status of the next goal tells it,
too. A goal that the next one replaces is over too early, so this excuses no server."""


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
        asked_ns, is_refused = time.time_ns(), False
        for position in first, second:  # the arm ends there if a rejected goal leads it astray
            was_over = moving.is_over()
            too_many = server.send(goal(position, speed=TOO_MANY_SPEED), ends=other)
            # a server that blocks its other callbacks during a move answers only after it
            if moving.is_over() or (too_many.is_accepted and _came_after(moving, arm, too_many)):
                break
            _expect_none_accepted(not too_many.is_accepted)
            is_refused = True
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
        if is_early:
            _expect_only_fast(arm, moving, first, asked_ns=asked_ns, is_refused=is_refused)
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


def _expect_only_fast(
    arm: WatchedArm, moving: SentGoal, position: Pose, *, asked_ns: int, is_refused: bool
) -> None:
    """Raise CheckFailed if a move ended early, unless it only was too fast and arrived.

    A speed that is wrong before the second goal comes, at `asked_ns`, is the fault that other
    checks report. Only if the move is over by then, no goal can be refused (`is_refused`).
    """
    why = arm.why_ended(moving)
    if not why and _was_too_fast(arm, moving, position, before_ns=asked_ns):
        if is_refused and arm.has_result(moving) and is_near(moving.result.position, position):
            return
        wanted_sec = far_rad(arm.start, position) / moving.goal.speed
        expect(
            is_refused,
            expected=f'a move that takes {wanted_sec:.1f} s',
            seen='it over before a second goal could be rejected',
            hint=why_speed(arm, position, moving.goal.speed, seconds=arm.seconds(moving)),
            cause='the move is over too soon for a second goal',
        )
    fail(
        expected='the first goal to go on when a second one is rejected',
        seen='it ended early',
        hint=why
        or 'leave the goal that moves the arm alone: the goal callback alone answers the second',
        cause='a second goal disturbs the first',
    )


def _was_too_fast(arm: WatchedArm, moving: SentGoal, position: Pose, *, before_ns: int) -> bool:
    """Whether the arm was far ahead of its time, or there already, at a wall time in ns."""
    if 0 < moving.over_ns() < before_ns:
        return True
    told = [
        (sent_ns, message.position)
        for sent_ns, message in moving.feedback()
        if sent_ns < before_ns and len(message.position) == len(position)
    ]
    if not told:
        return False
    sent_ns, seen = told[-1]
    due_rad = moving.goal.speed * arm.seconds_since_sent(moving, sent_ns)
    return EARLY_PART * far_rad(arm.start, seen) > due_rad


def _came_after(moving: SentGoal, arm: WatchedArm, accepted: SentGoal) -> bool:
    """Whether the server got the accepted goal after the end of `moving`, which it told late."""
    if arm.time.is_driven:  # such a server answers during a move
        return False
    arm.server.watcher.spin_until_free(moving.is_over, free_sec=TOLD_SEC)
    stamp = accepted.answer.result().stamp
    return 0 < moving.over_ns() <= stamp.sec * 10**9 + stamp.nanosec + LOST_NS


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
