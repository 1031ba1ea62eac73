"""Whether a goal of `/move_arm` brings the arm to its position, at the requested speed."""

from my_robot_basics.checks.actions.action_ends import ActionEnds, SentGoal
from my_robot_basics.checks.actions.actions import Action
from my_robot_basics.checks.arm.arm_looks import look
from my_robot_basics.checks.arm.arm_pace import wait_for_end
from my_robot_basics.checks.arm.arm_results import (
    expect_arrived,
    expect_result,
    expect_succeeded,
    is_near,
    why_no_success,
)
from my_robot_basics.checks.arm.arm_speed import expect_no_slow_move, expect_speed
from my_robot_basics.checks.arm.speed_hints import FROM_HERE
from my_robot_basics.checks.arm.watched_arm import HASTE_SEC, Pose, WatchedArm, far_rad, goal
from my_robot_basics.checks.clock.robot_time import DUE_SEC, DrivenTime
from my_robot_basics.feedback.errors import expect, fail

MOST_TIMES = 3.0
"""A check waits for the end of a move so many times as long as the move should take."""
MORE_SEC = 1.0
"""How many seconds longer it waits than MOST_TIMES says."""
AT_ONCE_SEC = 0.3
"""How long a goal to where the arm is may take: two steps of a server may take 0.2 s."""
MEET_SEC = 2.0
"""How long a second client may take to discover the server, in seconds."""
LEAVES_SPEED = 0.5
"""Speed of a move whose client leaves, in rad/s."""


def expect_reaches(
    action: Action, position: Pose, *, speed: float, start: Pose = (0.0, 0.0)
) -> None:
    """Send the arm from `start` to a position (rad) at a speed (rad/s); the goal has to succeed.

    The result has to hold the position. Two goals to where the arm is then have to succeed,
    too, the second one at once. Raises CheckFailed.
    """

    def arrives(arm: WatchedArm) -> None:
        sent = _arrive(arm, position, speed=speed)
        expect_speed(arm, sent, position)
        expect(
            not arm.computes_on_wall,
            expected="a move that takes its time on the node's clock",
            seen='one by the wall clock, although the robot has another one (use_sim_time)',
            hint='take the time that has passed from self.get_clock().now(), and not from time',
            cause='the time that has passed is that of another clock',
        )
        arm.start = tuple(position)
        for is_there in False, True:  # rounding may leave the first one a short way to go
            _expect_stays(arm, speed=speed, is_there=is_there)

    look(action, arrives, start=start)


def expect_serves_on(action: Action, position: Pose, *, start: Pose = (0.0, 0.0)) -> None:
    """Send a goal from a client that leaves; the server has to serve the next client's goal.

    No other move of the exercise is checked at so high a speed. Raises CheckFailed.
    """

    def serves_on(arm: WatchedArm) -> None:
        vanishes = ActionEnds(arm.server.watcher, arm.server.name, arm.server.type)
        arm.server.watcher.spin_until(vanishes.is_connected, timeout_sec=MEET_SEC)
        sent = arm.server.send(arm.goal(position, speed=LEAVES_SPEED), ends=vanishes)
        vanishes.leave()
        wanted_sec = far_rad(arm.start, position) / sent.goal.speed
        if not arm.time.wait(
            lambda: not arm.server.has_active(), seconds=MOST_TIMES * wanted_sec + MORE_SEC
        ):
            expect_no_slow_move(arm, sent, position)
            arm.server.fail_without_end(
                sent,
                it=f'it {sent.status} after its client has left',
                none='none after its client has left',
            )
        back = arm.start
        arm.start = tuple(position)
        expect_speed(arm, _arrive(arm, back, speed=LEAVES_SPEED), back)

    look(action, serves_on, start=start)


def _arrive(arm: WatchedArm, position: Pose, *, speed: float) -> SentGoal:
    """Send the arm there, and return the goal, which has succeeded. Raises CheckFailed."""
    sent = arm.send(arm.goal(position, speed=speed))
    wanted_sec = far_rad(arm.start, position) / sent.goal.speed
    most_sec = MOST_TIMES * wanted_sec + MORE_SEC
    if not wait_for_end(arm, sent, position, seconds=most_sec):
        expect_no_slow_move(arm, sent, position)
        arm.server.fail_without_end(
            sent,
            it=f'it {sent.status} in {most_sec:.0f} s, for a move of {wanted_sec:.1f} s',
            none=f'none in {most_sec:.0f} s, for a move of {wanted_sec:.1f} s',
        )
    expect_succeeded(arm, sent)
    expect_arrived(sent, position, start=arm.start, why=arm.why_unmoved(sent))
    return sent


def _expect_stays(arm: WatchedArm, *, speed: float, is_there: bool) -> None:
    """Send a goal to where the arm is; it succeeds, at once if `is_there`. Raises CheckFailed."""
    sent = arm.server.send(goal(arm.start, speed=speed))
    expect(
        sent.is_accepted,
        expected='a goal to where the arm is already to be accepted',
        seen='it rejected',
        hint='the arm is at the goal, so accept it, and let it succeed at once',
        cause='a goal to where the arm is already is rejected',
    )
    is_late = is_there and not _ends_at_once(arm, sent)
    if not arm.time.wait(sent.is_over, seconds=HASTE_SEC):
        moves = any(not is_near(message.position, arm.start) for _, message in sent.feedback())
        fail(
            expected='a goal to where the arm is already to end at once',
            seen=f'no end in {HASTE_SEC:g} s',
            hint=FROM_HERE if moves else arm.server.why_no_end(sent),
            cause='a goal to where the arm is already does not end',
        )
    expect_result(arm, sent)
    if sent.status != 'succeeded':
        fail(
            expected='a goal to where the arm is already to succeed',
            seen=f'it {sent.status}',
            hint=f'the arm is there already, and so is at the goal: {why_no_success(arm, sent)}',
            cause=f'a goal to where the arm is already is {sent.status}',
        )
    expect_arrived(sent, arm.start, start=arm.start)
    expect(
        not is_late,
        expected='a goal to where the arm is already to end at once',
        seen=f'it {sent.status} after {arm.seconds(sent):.1f} s',
        hint='a move of 0 rad takes no time: set no minimum time for a move, and wait for '
        'nothing else',
        cause='a goal to where the arm is already does not end at once',
    )


def _ends_at_once(arm: WatchedArm, sent: SentGoal) -> bool:
    """Whether a goal ends within AT_ONCE_SEC of the robot's time.

    After each tick, a thread of the node gets DUE_SEC of free time to act. On the wall clock, the
    result is always True: a busy machine may delay the end.
    """
    if not isinstance(arm.time, DrivenTime):
        return True
    for _ in range(round(AT_ONCE_SEC * 1e9 / arm.time.step_ns)):
        arm.time.let_pass(sent.is_over, seconds=arm.time.step_ns / 1e9)
        if arm.server.watcher.spin_until_free(sent.is_over, free_sec=DUE_SEC):
            return True
    return False
