"""How a goal of `/move_arm` ended: its status, and the position in its result."""

import math
from collections.abc import Sequence

from my_robot_basics.checks.actions.accepted_goals import never_moves
from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm
from my_robot_basics.checks.values import joints
from my_robot_basics.feedback.errors import expect, fail, shorten

WITHIN_RAD = 0.005
"""An arm that is as near as this to its goal has arrived."""
ELSEWHERE = 'put in the positions of both joints, in radians'
NOT_THERE = (
    'let the last step end at the goal, and not before it or beyond it (`part = min(1.0, …)`), '
    'and call succeed() then'
)
IN_DEGREES = 'these are degrees: all positions of MoveArm are in radians'
ASIDE_RAD = 0.05
"""An arm that is farther than this from its goal is elsewhere."""
CLOSE_RAD = 0.6
"""A position that is no farther off than this is not a mistake of units, such as degrees."""


def expect_succeeded(arm: WatchedArm, sent: SentGoal) -> None:
    """Expect a goal that was reached to succeed, with a result. Raises CheckFailed."""
    expect_result(arm, sent)
    if sent.status != 'succeeded':
        fail(
            expected='the goal to be succeeded at its end',
            seen=f'it {sent.status}',
            hint=why_no_success(arm, sent),
            cause=f'a goal that was reached is {sent.status}',
        )


def expect_result(arm: WatchedArm, sent: SentGoal) -> None:
    """Expect the result of a goal that has ended to arrive. Raises CheckFailed."""
    expect(
        arm.has_result(sent),
        expected='a result',
        seen=f'the status {sent.status}, and no result',
        hint='end the execute callback with `return MoveArm.Result(position=…)`, in each branch',
        cause='there is no result',
    )


def why_aborted(arm: WatchedArm, sent: SentGoal, *, instead: str) -> str:
    """Advice if a goal was aborted; `instead`: the method that should have been called."""
    log = arm.server.log
    if raised := log.raised(since_ns=sent.sent_ns):
        return raised
    if log.was_not_set(since_ns=sent.sent_ns):
        return (
            f'call goal_handle.{instead}() before the execute callback returns: rclpy aborts a '
            'goal whose state nobody has set'
        )
    return f'call goal_handle.{instead}(), and not abort()'


def why_no_success(arm: WatchedArm, sent: SentGoal) -> str:
    """Advice if a goal that was reached has not succeeded."""
    if sent.status == 'aborted':
        return why_aborted(arm, sent, instead='succeed')
    return 'call goal_handle.succeed() when the arm is there'


def expect_arrived(sent: SentGoal, position: Pose, *, start: Pose, why: str = '') -> None:
    """Expect the result to hold that position (rad); `why` not, if known. Raises CheckFailed."""
    seen = list(sent.result.position)
    if not is_near(seen, position):
        fail(
            expected=f'result.position {[round(each, 3) for each in position]}',
            seen=shorten([round(each, 3) for each in seen]),
            hint=why or why_off(seen, position, start=start),
            cause='the result does not hold the position',
        )


def expect_there(sent: SentGoal, position: Pose) -> None:
    """Raise CheckFailed if a goal succeeded, but its result says that the arm is elsewhere.

    A result that the last feedback contradicts is no evidence, and does not raise.
    """
    told = [list(message.position) for _, message in sent.feedback()]
    seen = list(sent.result.position) if sent.result is not None else []
    if sent.status != 'succeeded' or not seen or (told and not is_near(seen, told[-1])):
        return
    is_close = is_near(seen, position, within_rad=CLOSE_RAD)
    why = NOT_THERE if is_close else why_off(seen, position, start=())
    if why in (NOT_THERE, ELSEWHERE):
        why = NOT_THERE if told else never_moves()
    if not is_near(seen, position, within_rad=ASIDE_RAD):
        fail(
            expected=f'the arm at {[round(each, 3) for each in position]} after a goal there',
            seen=f'it at {shorten([round(each, 3) for each in seen])}, as the result says',
            hint=why,
            cause='the arm is not where a goal has brought it',
        )


def is_near(seen: Sequence[float], wanted: Pose, within_rad: float = WITHIN_RAD) -> bool:
    """Whether each joint is within `within_rad` of the wanted position."""
    return len(seen) == len(wanted) and all(
        abs(a - b) <= within_rad for a, b in zip(seen, wanted, strict=True)
    )


def why_off(seen: Sequence[float], wanted: Pose, *, start: Pose) -> str:
    """Advice for a position that is not the wanted one."""
    if not seen:
        return 'fill in the position: MoveArm.Result(position=…)'
    if is_near(seen, start):
        return 'this is where the arm was: put in where it is in the end'
    if is_near(seen, [math.degrees(each) for each in wanted], within_rad=0.5):
        return IN_DEGREES
    if is_near(seen, [math.radians(each) for each in wanted], within_rad=1e-3):
        return 'the positions of MoveArm are in radians already'
    if any(is_near(seen, [round(each, places) for each in wanted], 1e-6) for places in (0, 1)):
        return 'do not round the positions'
    if is_near(seen, wanted, within_rad=ASIDE_RAD):
        return NOT_THERE
    why = joints.why_off(seen, [math.degrees(each) for each in wanted])
    return why if 'convert' not in why else ELSEWHERE
