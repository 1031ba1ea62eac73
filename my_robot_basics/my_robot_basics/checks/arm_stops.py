"""What becomes of a goal of `/move_arm` that was cancelled: its status and its result."""

import math

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.arm_moves import is_near, why_aborted
from my_robot_basics.checks.watched_arm import Pose, WatchedArm
from my_robot_basics.feedback.errors import fail, shorten

ON_LINE_RAD = 0.02
FIRST_SEC = 0.3
"""The first feedback comes so long after the begin of a move, at the latest."""


def expect_canceled(arm: WatchedArm, sent: SentGoal) -> None:
    """Its status is canceled. Raises CheckFailed."""
    if sent.status == 'canceled':
        return
    hint = 'the arm was stopped: call goal_handle.canceled(), not succeed()'
    if sent.status == 'aborted':
        hint = why_aborted(arm, sent, instead='canceled')
    fail(
        expected='the goal to be canceled when the arm was stopped',
        seen=f'it {sent.status}',
        hint=hint,
        cause=f'a goal that was cancelled is {sent.status}',
    )


def expect_on_the_way(sent: SentGoal, position: Pose, *, start: Pose) -> None:
    """Its result holds a position between start and goal. Raises CheckFailed."""
    seen = list(sent.result.position)
    ways = [b - a for a, b in zip(start, position, strict=True)]
    joint = max(range(len(ways)), key=lambda number: abs(ways[number]))
    hint = ''
    if not seen:
        hint = 'fill in the result of a goal that was cancelled, too: MoveArm.Result(position=…)'
    elif len(seen) != len(ways) or not all(map(math.isfinite, seen)):
        hint = 'put one position for each joint into the result'
    elif is_near(seen, position):
        hint = 'put in where the arm is, not where it was to go'
    else:
        part = (seen[joint] - start[joint]) / ways[joint]
        there = [a + part * way for a, way in zip(start, ways, strict=True)]
        if not 0.0 < part < 1.0 or not is_near(seen, there, ON_LINE_RAD):
            hint = 'put in where the arm was stopped, on its way, in radians'
    if hint:
        fail(
            expected='where the arm was stopped in the result',
            seen=shorten([round(each, 3) for each in seen]),
            hint=hint,
            cause='the result of a cancelled goal is wrong',
        )


def expect_begins_at(arm: WatchedArm, moved: SentGoal) -> None:
    """The feedback of a move begins where the arm was. Raises CheckFailed."""
    feedback = moved.feedback()
    near_rad = FIRST_SEC * moved.goal.speed + ON_LINE_RAD
    if feedback and len(feedback[0][1].position) == len(arm.start):
        seen = list(feedback[0][1].position)
        if not is_near(seen, arm.start, near_rad):
            fail(
                expected=f'the next move to begin at {[round(each, 3) for each in arm.start]}',
                seen=f'{[round(each, 3) for each in seen]}',
                hint='a move begins where the arm was stopped: remember its position in each step',
                cause='the next move begins elsewhere',
            )
