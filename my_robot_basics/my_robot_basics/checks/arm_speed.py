"""Whether a move took as long as it should, whatever the server waits for between its steps."""

import math
from typing import NoReturn

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.arm_progress import BY_TIME, bring, is_under_way
from my_robot_basics.checks.reported_speed import FEWEST, ReportedSpeed, reported_speed
from my_robot_basics.checks.robot_time import DrivenTime
from my_robot_basics.checks.watched_arm import Pose, WatchedArm, far_rad
from my_robot_basics.feedback.errors import CheckFailed, fail

TOLERANCE, WALL_TOLERANCE = 0.02, 0.05
SLACK_SEC = 0.12
"""So much more or less is one step of the server's, and one of the clock."""
TOLD_WALL_TOLERANCE, STEP_LATE_SEC = 0.03, 0.0015
"""What feedback tells on the wall clock; each step of a loop that adds them up is so late."""
FAR_PART = 0.12
"""A busy machine makes feedback tell no speed that is so far off."""
PLAUSIBLE = 0.8, 1.25
"""Feedback that tells another speed is itself wrong: the time alone counts then."""
FINEST = 0.0005, 0.45
"""A step of the clock, and for how long the arm moves, in seconds: a server whose sleeps are no
multiple of the clock's steps sleeps longer than it means to, and less so with finer ones. …"""
FINER = 0.002, 4.0
"""… Where too little feedback tells the speed in that time, the move has to be longer."""
SLOW_PART = 0.5
"""If the feedback tells a speed so much lower, no busy machine is the cause."""
MOST_TIMES = 3.0
JUMP_SEC = 0.3
"""An arm that takes no longer does not move at a speed: it jumps."""
ALIKE = 0.03
"""So near is a wrong speed to the one that a mistake makes."""
FROM_HERE = 'start from where the arm is, at each goal'


def expect_speed(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    """A goal that was reached has taken as long as its speed asks for. Raises CheckFailed.

    The feedback on it, where it can be right, tells the speed better than one step of the server.
    """
    wanted_sec = far_rad(arm.start, position) / sent.goal.speed
    seconds = arm.seconds(sent)
    # feedback that a busy machine delays looks like a step that was lost, and makes no move faster
    seconds -= min(arm.lost_sec, max(0.0, seconds - wanted_sec))
    told = reported_speed(arm, sent, position)
    least, most = PLAUSIBLE
    tells = least <= told.rad_per_sec / sent.goal.speed <= most
    is_told_right = tells and _is_right(arm, told, sent.goal.speed)
    tolerance = TOLERANCE if arm.time.is_driven else WALL_TOLERANCE
    off_sec, slack_sec = seconds - wanted_sec, tolerance * wanted_sec + SLACK_SEC
    late_sec = arm.stalled_sec() if is_told_right else 0.0
    is_in_time = -slack_sec <= off_sec <= slack_sec + late_sec
    if is_in_time and (is_told_right or not tells):
        return
    is_proven = off_sec < -slack_sec or _is_proven(told, sent, wanted_sec, seconds)
    doubt = CheckFailed if is_proven else arm.doubt()
    if is_in_time:
        seconds = wanted_sec * sent.goal.speed / told.rad_per_sec
    is_slow = wanted_sec < seconds
    if is_slow and arm.time.is_driven and _is_right_in_finer_steps(arm, sent, position):
        return
    _fail_speed(arm, sent, position, seconds=seconds, wanted_sec=wanted_sec, doubt=doubt)


def expect_no_slow_move(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    """A goal that has not ended in time is not one of an arm that is slow, by its feedback.

    Raises CheckFailed.
    """
    told = reported_speed(arm, sent, position).rad_per_sec
    if told and told < SLOW_PART * sent.goal.speed and is_under_way(arm, sent, position):
        far = far_rad(arm.start, position)
        seconds, wanted_sec = far / told, far / sent.goal.speed
        fail(
            expected=f'{wanted_sec:.1f} s for {far:.2f} rad at {sent.goal.speed:.3g} rad/s',
            seen=f'{seconds:.0f} s, as the feedback tells',
            hint=_why_speed(arm, position, seconds * sent.goal.speed, seconds=seconds),
            cause='the arm is too slow',
        )


def _is_proven(told: ReportedSpeed, sent: SentGoal, wanted_sec: float, seconds: float) -> bool:
    """Whether feedback and end agree on another speed, so that no busy machine has made it.

    It slows a loop down that adds up steps, and makes no move faster.
    """
    if not told.rad_per_sec or told.step_sec:
        return False
    told_sec = wanted_sec * sent.goal.speed / told.rad_per_sec
    is_far = abs(told_sec - wanted_sec) > FAR_PART * wanted_sec
    return is_far and abs(told_sec - seconds) <= FAR_PART * seconds


def _is_right(arm: WatchedArm, told: ReportedSpeed, speed: float) -> bool:
    """Whether the speed is right by what the feedback tells."""
    times = told.rad_per_sec / speed
    tolerance = TOLERANCE if arm.time.is_driven else TOLD_WALL_TOLERANCE
    late = STEP_LATE_SEC / told.step_sec if told.step_sec else 0.0
    return 1.0 / (1.0 + tolerance + late) <= times <= 1.0 + tolerance


def _is_right_in_finer_steps(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    assert isinstance(arm.time, DrivenTime)
    rate_hz = len(sent.feedback()) / arm.seconds(sent)
    tells = reported_speed(arm, sent, position).rad_per_sec and rate_hz * FINEST[1] >= FEWEST
    step_sec, seconds = FINEST if tells else FINER
    bring(arm, arm.start)
    former_ns, arm.time.step_ns = arm.time.step_ns, round(step_sec * 1e9)
    try:
        return abs(_slowness(arm, position, seconds=seconds) - 1.0) <= TOLERANCE
    finally:
        arm.time.step_ns = former_ns


def _slowness(arm: WatchedArm, position: Pose, *, seconds: float) -> float:
    """How many times as long as it should a move takes that should take so many seconds."""
    sent = arm.send(arm.goal(position, speed=far_rad(arm.start, position) / seconds))
    if not arm.time.wait(sent.is_over, seconds=MOST_TIMES * seconds):
        return MOST_TIMES
    told = reported_speed(arm, sent, position)
    if told.rad_per_sec:
        return sent.goal.speed / told.rad_per_sec
    off_sec = arm.seconds(sent) - seconds
    return 1.0 + math.copysign(max(0.0, abs(off_sec) - SLACK_SEC), off_sec) / seconds


def _fail_speed(
    arm: WatchedArm,
    sent: SentGoal,
    position: Pose,
    *,
    seconds: float,
    wanted_sec: float,
    doubt: type[CheckFailed],
) -> NoReturn:
    far = far_rad(arm.start, position)
    digits = 1 if abs(seconds - wanted_sec) >= 0.1 else 2
    fail(
        expected=f'{wanted_sec:.{digits}f} s for {far:.2f} rad at {sent.goal.speed:.3g} rad/s',
        seen=f'{seconds:.{digits}f} s',
        hint=(seconds <= JUMP_SEC and arm.why_too_soon(sent))
        or _why_speed(arm, position, seconds * sent.goal.speed, seconds=seconds),
        cause='the arm is too slow' if wanted_sec < seconds else 'the arm is too fast',
        doubt=doubt,
    )


def _why_speed(arm: WatchedArm, position: Pose, product: float, *, seconds: float) -> str:
    """What to try; `product` is the time that it took times the speed asked for, in rad."""
    ways = [abs(b - a) for a, b in zip(arm.start, position, strict=True)]
    causes = {
        math.radians(max(ways)): 'the speed is in rad/s already, as the positions are in rad',
        math.degrees(max(ways)): 'the speed is in rad/s already, as the positions are in rad',
        math.hypot(*ways): 'the speed is that of the faster joint, not of both together',
        sum(ways): 'both joints move at once: start and arrive together',
        min(ways): 'the speed is that of the joint that has farther to go',
        max(map(abs, position)): FROM_HERE,
    }
    wrong = {rad: why for rad, why in causes.items() if abs(rad - max(ways)) > ALIKE * rad}
    found = [why for rad, why in wrong.items() if abs(product - rad) <= ALIKE * rad]
    if found:
        return found[0]
    if seconds <= JUMP_SEC:
        return 'the arm jumps: move it a little in each step, by speed × the time of the step'
    return BY_TIME
