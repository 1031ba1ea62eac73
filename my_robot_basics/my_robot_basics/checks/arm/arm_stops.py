"""How a cancelled goal of `/move_arm` ended: its status, its result, and the next move."""

import math
from collections.abc import Sequence

import numpy as np

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.arm_lines import ON_LINE_RAD, off_line
from my_robot_basics.checks.arm.arm_results import IN_DEGREES, is_near, why_aborted
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, faster_joint
from my_robot_basics.checks.values.joints import SIGNS, SWAPPED
from my_robot_basics.feedback.errors import fail, shorten

ON_LINE, NEAR_RAD = 0.05, 0.02
"""How far a joint may be beyond its way, as a part of it; how near the next move has to begin."""
FIRST_SEC = 0.3
"""When the first feedback comes at the latest, in seconds after the start of a move."""


def expect_canceled(arm: WatchedArm, sent: SentGoal) -> None:
    """Expect the status canceled. Raises CheckFailed."""
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


def expect_on_the_way(arm: WatchedArm, sent: SentGoal, position: Pose, *, start: Pose) -> None:
    """Expect a position between `start` and the goal in the result. Raises CheckFailed."""
    seen = list(sent.result.position)
    hint = ''
    if not seen:
        hint = arm.server.log.raised(since_ns=sent.sent_ns) or (
            'fill in the result of a goal that was cancelled, too: MoveArm.Result(position=…)'
        )
    elif len(seen) != len(position) or not all(map(math.isfinite, seen)):
        hint = 'put one position for each joint into the result'
    elif is_near(seen, position):
        hint = _why_at_the_goal(sent, position)
    elif not _is_between(seen, start, position) and not _is_told(seen, sent, start, position):
        hint = _why_beside(seen, start, position)
    if hint:
        fail(
            expected='where the arm was stopped in the result',
            seen=shorten([round(each, 3) for each in seen]),
            hint=hint,
            cause='the result of a cancelled goal is wrong',
        )


def _is_told(seen: Sequence[float], sent: SentGoal, start: Pose, position: Pose) -> bool:
    """Whether the feedback, too, told this position, and one joint is on its way there.

    If the other one has not begun to move, another check says that the line is not straight.
    """
    told = [list(message.position) for _, message in sent.feedback()]
    parts = _parts(seen, start, position)
    is_inside = all(-ON_LINE < each < 1.0 + ON_LINE for each in parts)
    is_moving = any(0.0 < each < 1.0 for each in parts)
    return bool(told) and is_near(told[-1], seen, NEAR_RAD) and is_inside and is_moving


def _why_beside(seen: Sequence[float], start: Pose, position: Pose) -> str:
    """Advice for a position that is not on the way, by the mistake it looks like."""
    if _is_on_way(seen[::-1], start, position):
        return SWAPPED
    if not _is_far_joint_between(seen, start, position) and _is_between(
        [math.radians(each) for each in seen], start, position
    ):
        return IN_DEGREES
    for why, signs in SIGNS.items():
        if _is_on_way([a * b for a, b in zip(signs, seen, strict=True)], start, position):
            return why
    return 'put in where the arm was stopped, on its way, in radians'


def _is_on_way(seen: Sequence[float], start: Pose, goal: Pose) -> bool:
    """Whether the arm passes there: a goal (a, -b) makes swapped joints look like wrong signs."""
    is_on_line = off_line(np.array([seen]), start, goal)[0] <= ON_LINE_RAD
    return bool(is_on_line) and _is_between(seen, start, goal)


def _is_between(seen: Sequence[float], start: Pose, goal: Pose) -> bool:
    """Whether each joint is on its way, and the one with the longest way at neither end of it."""
    return _is_far_joint_between(seen, start, goal) and all(
        -ON_LINE < each < 1.0 + ON_LINE for each in _parts(seen, start, goal)
    )


def _parts(seen: Sequence[float], start: Pose, goal: Pose) -> list[float]:
    """Which part of its way each joint has behind it; without joints that do not move."""
    ways = [b - a for a, b in zip(start, goal, strict=True)]
    return [(each - a) / way for each, a, way in zip(seen, start, ways, strict=True) if way]


def _is_far_joint_between(seen: Sequence[float], start: Pose, goal: Pose) -> bool:
    """Whether the joint with the longest way is on it; in degrees, it would be far beyond it."""
    joint = faster_joint(start, goal)
    return 0.0 < (seen[joint] - start[joint]) / (goal[joint] - start[joint]) < 1.0


def _why_at_the_goal(sent: SentGoal, position: Pose) -> str:
    told = [list(message.position) for _, message in sent.feedback()]
    if told and is_near(told[-1], position):
        return (
            'the arm was there long before its time: compute each position from where the move '
            'began, and keep that in a list of its own, list(self.position)'
        )
    return 'put in where the arm is, not where it was to go'


def last_told(sent: SentGoal, otherwise: Pose) -> tuple[float, ...]:
    """Return where the arm is by its last feedback, in rad; `otherwise` without a position."""
    told = [tuple(message.position) for _, message in sent.feedback()][-1:]
    is_pose = bool(told) and len(told[0]) == len(otherwise) and all(map(math.isfinite, told[0]))
    return told[0] if is_pose else tuple(otherwise)


def expect_begins_at(arm: WatchedArm, stopped: Pose, moved: SentGoal, *, former: SentGoal) -> None:
    """Expect the feedback on `moved` to begin where the goal before it, `former`, was stopped.

    Nothing is checked if the last feedback on `former` is not near `stopped`. Raises CheckFailed.
    """
    before = [list(message.position) for _, message in former.feedback()]
    after = [list(message.position) for _, message in moved.feedback()]
    near_rad = FIRST_SEC * max(former.goal.speed, moved.goal.speed) + NEAR_RAD
    if not before or not after or not is_near(before[-1], stopped, near_rad):
        return
    # the arm may have moved since the goal was sent
    late_sec = arm.seconds_since_sent(moved, moved.feedback()[0][0])
    near_rad += max(0.0, late_sec - FIRST_SEC) * moved.goal.speed
    if len(after[0]) == len(stopped) and not is_near(after[0], stopped, near_rad):
        hint = (
            'a move begins where the arm was stopped: remember its position in each step, and let '
            'nothing move it after canceled()'
        )
        if is_near(after[0], moved.goal.position):
            # this goal is where the arm came from: it went back there, or is there at once now
            hint = (
                'a move begins where the arm was stopped: remember its position in each step, let '
                'nothing move it after canceled(), and let a move back take its time, too'
            )
        fail(
            expected=f'the next move to begin at {[round(each, 3) for each in stopped]}',
            seen=f'{[round(each, 3) for each in after[0]]}',
            hint=hint,
            cause='the next move begins elsewhere',
        )
