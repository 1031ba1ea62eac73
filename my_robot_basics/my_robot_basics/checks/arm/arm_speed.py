"""Whether a move took as long as it should, however long the server's steps are."""

import math

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.arm_progress import bring, is_under_way
from my_robot_basics.checks.arm.reported_speed import (
    FEWEST,
    ReportedSpeed,
    reported_speed,
    rest_of,
)
from my_robot_basics.checks.arm.speed_hints import JUMP_SEC, why_speed
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, far_rad
from my_robot_basics.checks.clock.robot_time import DrivenTime
from my_robot_basics.feedback.errors import CheckFailed, fail

TOLERANCE, WALL_TOLERANCE = 0.02, 0.05
"""How far off the time of a move may be, as a part of it; the same on the wall clock."""
SLACK_SEC = 0.12
"""By how much a move may be longer or shorter: a step of the server, and one of the clock."""
TOLD_WALL_TOLERANCE, STEP_LATE_SEC = 0.03, 0.0015
"""Tolerance of the feedback's speed on the wall clock; how late each sleep may end in a loop that
adds up steps."""
FAR_PART = 0.12
"""A busy machine does not make the feedback's speed wrong by more than this part."""
PLAUSIBLE = 0.8, 1.25
"""If the feedback's speed is outside these parts of the requested one, the feedback is wrong, and
only the time of the move counts."""
FINEST = 0.0005, 0.45
"""The step of the clock and the time of the move, in seconds, of a second look. A server whose
sleep is not a multiple of the clock's step sleeps too long, but less so with finer steps. If the
first messages come one step late, and the others do not, the feedback shows too high a speed."""
FINER = 0.002, 4.0
"""The same with a longer move, if too little feedback comes in the time of FINEST."""
SLOW_PART = 0.5
"""If the feedback shows less than this part of the speed, a busy machine is not the cause."""
MOST_TIMES = 3.0


def expect_speed(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    """Expect a goal that was reached to have taken as long as its speed requires.

    If its feedback is plausible, it shows the speed more exactly than the time of the move, which
    may be off by a step of the server. Raises CheckFailed.
    """
    wanted_sec = far_rad(arm.start, position) / sent.goal.speed
    seconds = arm.seconds(sent)
    # late feedback on a busy machine may look like a lost step: it must not make a move too fast
    seconds -= min(arm.lost_sec, max(0.0, seconds - wanted_sec))
    told = reported_speed(arm, sent, position)
    least, most = PLAUSIBLE
    tells = least <= told.rad_per_sec / sent.goal.speed <= most
    is_told_right = tells and _is_right(arm, told, sent.goal.speed)
    tolerance = TOLERANCE if arm.time.is_driven else WALL_TOLERANCE
    off_sec, slack_sec = seconds - wanted_sec, tolerance * wanted_sec + SLACK_SEC
    rest = rest_of(arm, sent, position)
    late_sec = arm.stalled_sec() if is_told_right and rest.sec <= slack_sec else 0.0
    is_in_time = -slack_sec <= off_sec <= slack_sec + late_sec
    if is_in_time and (is_told_right or not tells):
        return
    is_proven = (
        off_sec < -slack_sec
        or rest.alone_sec > slack_sec
        or _is_proven(told, sent, wanted_sec, seconds)
    )
    doubt = CheckFailed if is_proven else arm.doubt()
    is_uneven = False  # slower at first and at the end than in between, for example
    if is_in_time:
        told_sec = wanted_sec * sent.goal.speed / told.rad_per_sec
        is_uneven, seconds = abs(told_sec - seconds) > slack_sec, told_sec
    far = far_rad(arm.start, position)
    rests = is_told_right and off_sec > 0.0
    why = why_speed(arm, position, sent.goal.speed, seconds=seconds, rests=rests)
    may_be_right = wanted_sec < seconds or is_in_time
    if may_be_right and arm.time.is_driven:
        # an arm that tells the right speed adds up no steps, but may stand still on its way
        finer = FINER if is_told_right else _finer_steps(arm, sent, position)
        if _is_right_in_finer_steps(arm, sent, position, finer):
            return
    digits = 1 if abs(seconds - wanted_sec) >= 0.1 else 2
    fail(
        expected=f'{wanted_sec:.{digits}f} s for {far:.2f} rad at {sent.goal.speed:.3g} rad/s',
        seen=f'{told.rad_per_sec:.3g} rad/s for the most part, as the feedback tells'
        if is_uneven
        else f'{seconds:.{digits}f} s',
        hint=(seconds <= JUMP_SEC and arm.why_too_soon(sent)) or why,
        cause='the arm is too slow' if wanted_sec < seconds else 'the arm is too fast',
        doubt=doubt,
    )


def expect_no_slow_move(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    """Raise CheckFailed if a goal has not ended in time because the arm is slow.

    The arm is slow if its feedback shows that it moves on, at less than SLOW_PART of its speed.
    """
    told = reported_speed(arm, sent, position).rad_per_sec
    if told and told < SLOW_PART * sent.goal.speed and is_under_way(arm, sent, position):
        far = far_rad(arm.start, position)
        seconds, wanted_sec = far / told, far / sent.goal.speed
        fail(
            expected=f'{wanted_sec:.1f} s for {far:.2f} rad at {sent.goal.speed:.3g} rad/s',
            seen=f'{seconds:.0f} s, as the feedback tells',
            hint=why_speed(arm, position, sent.goal.speed, seconds=seconds),
            cause='the arm is too slow',
        )


def _is_proven(told: ReportedSpeed, sent: SentGoal, wanted_sec: float, seconds: float) -> bool:
    """Whether feedback and time agree on a wrong speed, so that a busy machine is not the cause.

    That is never proven of a loop that adds up steps, because a busy machine slows it down.
    """
    if not told.rad_per_sec or told.step_sec:
        return False
    told_sec = wanted_sec * sent.goal.speed / told.rad_per_sec
    is_far = abs(told_sec - wanted_sec) > FAR_PART * wanted_sec
    return is_far and abs(told_sec - seconds) <= FAR_PART * seconds


def _is_right(arm: WatchedArm, told: ReportedSpeed, speed: float) -> bool:
    """Whether the feedback's speed is the requested one."""
    times = told.rad_per_sec / speed
    tolerance = TOLERANCE if arm.time.is_driven else TOLD_WALL_TOLERANCE
    late = STEP_LATE_SEC / told.step_sec if told.step_sec else 0.0
    return 1.0 / (1.0 + tolerance + late) <= times <= 1.0 + tolerance


def _finer_steps(arm: WatchedArm, sent: SentGoal, position: Pose) -> tuple[float, float]:
    """FINEST, or FINER if there is too little feedback for that."""
    rate_hz = len(sent.feedback()) / arm.seconds(sent)
    tells = reported_speed(arm, sent, position).rad_per_sec and rate_hz * FINEST[1] >= FEWEST
    return FINEST if tells else FINER


def _is_right_in_finer_steps(
    arm: WatchedArm, sent: SentGoal, position: Pose, finer: tuple[float, float]
) -> bool:
    """`finer`: the step of the clock and the time of the move, in seconds."""
    assert isinstance(arm.time, DrivenTime)
    step_sec, seconds = finer
    bring(arm, arm.start)
    former_ns, arm.time.step_ns = arm.time.step_ns, round(step_sec * 1e9)
    try:
        if abs(_slowness(arm, position, seconds=seconds) - 1.0) > TOLERANCE:
            return False
        # that move was faster: a server may be too slow only at the speed that was asked for, for
        # example if it rounds speeds down; a part of the way takes as long at that speed
        part = seconds * sent.goal.speed / far_rad(arm.start, position)
        if part >= 1.0:
            return True
        bring(arm, arm.start)
        ends = zip(arm.start, position, strict=True)
        near = [start + part * (end - start) for start, end in ends]
        is_right = _slowness(arm, near, seconds=seconds) <= 1.0 + TOLERANCE
        bring(arm, position)  # where the check goes on
        return is_right
    finally:
        arm.time.step_ns = former_ns


def _slowness(arm: WatchedArm, position: Pose, *, seconds: float) -> float:
    """Make a move that should take `seconds`: how many times as long it takes."""
    sent = arm.send(arm.goal(position, speed=far_rad(arm.start, position) / seconds))
    if not arm.time.wait(sent.is_over, seconds=MOST_TIMES * seconds):
        return MOST_TIMES
    off_sec = arm.seconds(sent) - seconds
    by_time = 1.0 + math.copysign(max(0.0, abs(off_sec) - SLACK_SEC), off_sec) / seconds
    told = reported_speed(arm, sent, position)
    if not told.rad_per_sec or by_time > 1.0 + TOLERANCE:
        return by_time
    return sent.goal.speed / told.rad_per_sec
