"""Whether the arm behind `/move_arm` gets where it is sent, at the speed asked for."""

import math
from collections.abc import Sequence

from my_robot_basics.checks import joints
from my_robot_basics.checks.action_ends import ActionEnds, SentGoal
from my_robot_basics.checks.actions import Action
from my_robot_basics.checks.arm_looks import look
from my_robot_basics.checks.arm_pace import wait_for_end
from my_robot_basics.checks.arm_speed import FROM_HERE, expect_no_slow_move, expect_speed
from my_robot_basics.checks.watched_arm import HASTE_SEC, Pose, WatchedArm, far_rad, goal
from my_robot_basics.feedback.errors import expect, fail, shorten

WITHIN_RAD = 0.005
"""An arm that is so near has arrived."""
MOST_TIMES = 3.0
"""A move is waited for so many times as long as it is to take."""
MORE_SEC = 1.0
"""… And so much longer."""
MEET_SEC = 2.0
"""How long a second client may take to meet the server."""
LEAVES_SPEED = 0.5
"""Of a move whose client leaves, in rad/s."""


def expect_reaches(
    action: Action, position: Pose, *, speed: float, start: Pose = (0.0, 0.0)
) -> None:
    """The arm goes from `start` to a position (rad) at that speed (rad/s), and the goal succeeds.

    The result holds the position. So does that of a goal to where the arm is then. Raises
    CheckFailed.
    """

    def arrives(arm: WatchedArm) -> None:
        sent = _arrive(arm, position, speed=speed)
        expect_speed(arm, sent, position)
        expect(
            not arm.has_two_clocks,
            expected="a move that takes its time on the node's clock",
            seen='one by the wall clock, although the robot has another one (use_sim_time)',
            hint='take the time that has passed from self.get_clock().now(), and not from time',
            cause='the time that has passed is that of another clock',
        )
        arm.start = tuple(position)
        for _ in range(2):  # the first one may have a way to go that is due to rounding
            _expect_stays(arm, speed=speed)

    look(action, arrives, start=start)


def expect_serves_on(action: Action, position: Pose, *, start: Pose = (0.0, 0.0)) -> None:
    """A client sends a goal and vanishes; the next client's goal is served all the same.

    It is the only move of the exercise that has to be so fast. Raises CheckFailed.
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
    """Send the arm there; the goal, which has succeeded. Raises CheckFailed."""
    sent = arm.send(arm.goal(position, speed=speed))
    wanted_sec = far_rad(arm.start, position) / sent.goal.speed
    most_sec = MOST_TIMES * wanted_sec + MORE_SEC
    if not wait_for_end(arm, sent, position, seconds=most_sec):
        expect_no_slow_move(arm, sent, position)
        arm.server.fail_without_end(
            sent,
            it=f'it {sent.status} in {most_sec:.0f} s of a move that takes a third',
            none=f'none in {most_sec:.0f} s of a move that takes a third',
        )
    _expect_succeeded(arm, sent)
    _expect_arrived(sent, position, start=arm.start)
    return sent


def _expect_stays(arm: WatchedArm, *, speed: float) -> None:
    """A goal to where the arm is already succeeds. Raises CheckFailed."""
    sent = arm.send(goal(arm.start, speed=speed))
    if not arm.time.wait(sent.is_over, seconds=HASTE_SEC):
        moves = any(not is_near(message.position, arm.start) for _, message in sent.feedback())
        fail(
            expected='a goal to where the arm is already to end at once',
            seen=f'none in {HASTE_SEC:g} s',
            hint=FROM_HERE if moves else arm.server.why_no_end(sent),
            cause='a goal to where the arm is already does not end',
        )
    expect_result(arm, sent)
    if sent.status != 'succeeded':
        fail(
            expected='a goal to where the arm is already to be succeeded',
            seen=f'it {sent.status}',
            hint=f'the arm is there already, and so is at the goal: {_why_not(arm, sent)}',
            cause=f'a goal to where the arm is already is {sent.status}',
        )
    _expect_arrived(sent, arm.start, start=arm.start)


def _expect_succeeded(arm: WatchedArm, sent: SentGoal) -> None:
    expect_result(arm, sent)
    if sent.status != 'succeeded':
        fail(
            expected='the goal to be succeeded at its end',
            seen=f'it {sent.status}',
            hint=_why_not(arm, sent),
            cause=f'a goal that was reached is {sent.status}',
        )


def expect_result(arm: WatchedArm, sent: SentGoal) -> None:
    """The result of a goal that is over arrives. Raises CheckFailed."""
    expect(
        arm.has_result(sent),
        expected='a result',
        seen=f'the status {sent.status}, and no result',
        hint='end the execute callback with `return MoveArm.Result(position=…)`, in each branch',
        cause='there is no result',
    )


def why_aborted(arm: WatchedArm, sent: SentGoal, *, instead: str) -> str:
    """What to try where a goal was aborted; `instead` is the call that is missing."""
    log = arm.server.log
    if raised := log.raised(since_ns=sent.sent_ns):
        return raised
    if log.was_not_set(since_ns=sent.sent_ns):
        return (
            f'call goal_handle.{instead}() before the execute callback returns: rclpy takes a '
            'goal whose state nobody has set for aborted'
        )
    return f'call goal_handle.{instead}(), and not abort()'


def _why_not(arm: WatchedArm, sent: SentGoal) -> str:
    if sent.status == 'aborted':
        return why_aborted(arm, sent, instead='succeed')
    return 'call goal_handle.succeed() when the arm is there'


def _expect_arrived(sent: SentGoal, position: Pose, *, start: Pose) -> None:
    seen = list(sent.result.position)
    if not is_near(seen, position):
        fail(
            expected=f'result.position {[round(each, 3) for each in position]}',
            seen=shorten([round(each, 3) for each in seen]),
            hint=why_off(seen, position, start=start),
            cause='the result does not hold the position',
        )


def is_near(seen: Sequence[float], wanted: Pose, within_rad: float = WITHIN_RAD) -> bool:
    """Whether all joints are there."""
    return len(seen) == len(wanted) and all(
        abs(a - b) <= within_rad for a, b in zip(seen, wanted, strict=True)
    )


def why_off(seen: Sequence[float], wanted: Pose, *, start: Pose) -> str:
    """What to try where a position is another one than wanted."""
    if not seen:
        return 'fill in the position: MoveArm.Result(position=…)'
    if is_near(seen, start):
        return 'this is where the arm was: put in where it is in the end'
    if is_near(seen, [math.degrees(each) for each in wanted], within_rad=0.5):
        return 'these are degrees: all positions of MoveArm are in radians'
    if is_near(seen, [math.radians(each) for each in wanted], within_rad=1e-3):
        return 'the positions of MoveArm are in radians already'
    why = joints.why_off(seen, [math.degrees(each) for each in wanted])
    return why if 'convert' not in why else 'put in the positions of both joints, in radians'
