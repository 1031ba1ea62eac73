"""An arm that moves too slowly: this costs only the points for its speed."""

import math
import time

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.arm_results import expect_there
from my_robot_basics.checks.arm.waits_in_vain import is_in_vain
from my_robot_basics.checks.arm.watched_arm import (
    HASTE,
    HASTE_SEC,
    SETTLE_SEC,
    STEP_NS,
    Pose,
    WatchedArm,
    far_rad,
    goal,
)
from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.clock.inconclusive import Inconclusive
from my_robot_basics.checks.clock.robot_time import DrivenTime
from my_robot_basics.feedback.errors import expect

BY_TIME = "in each step, move by speed × the time that passed, on the node's own clock"
FEWEST = 4
"""How many feedback messages are needed to tell that the arm moves."""
LATER_PART = 0.25
"""The later half of the messages has to cover this part of the way; steady moves cover half."""
LATEST_SEC = 1.5
"""How old the last message may be, in seconds of the arm's time."""
CALM = 0.5
"""Speed, in rad/s, for a server that rejects goals at HASTE: another check is about that."""
TELLS_SEC = 0.5
"""How long to drive the clock in haste until feedback shows whether the arm follows it."""
ASIDE_RAD = 0.3
"""How far, in rad, a goal is moved aside so that it is certainly another position."""
SOON_SEC = 1.0
"""A move at HASTE that has not ended after so many seconds is a slow one."""
SLOW_SEC = 20.0
"""How many seconds more a slow move may take on the wall clock."""


def is_under_way(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    """Whether the feedback on a goal shows an arm that still moves towards its position.

    False for an arm that slows down all the time, because it never arrives.
    """
    reports = sent.feedback()
    if sent.is_over() or len(reports) < FEWEST:
        return False
    if any(len(message.position) != len(position) for _, message in reports):
        return False
    silent_sec = (arm.time.now_ns() - arm.time.at_ns(reports[-1][0])) / 1e9
    left = [far_rad(message.position, position) for _, message in reports]
    gone, later = left[0] - left[-1], left[len(left) // 2] - left[-1]
    return silent_sec <= LATEST_SEC and left[-1] > 0.0 and later >= LATER_PART * gone > 0.0


def bring(arm: WatchedArm, position: Pose) -> None:
    """Bring the arm to a position (rad), at HASTE if the server accepts that speed.

    Raises CheckFailed if its result and its feedback say that the arm is not there then.
    """
    hasty, calm = goal(position, speed=HASTE), goal(position, speed=CALM)
    aside = goal([each - math.copysign(ASIDE_RAD, each) for each in position], speed=HASTE)
    sent = arm.send(hasty, calm, aside)
    if sent.goal is aside:  # a goal to where the arm is was rejected: another check reports that
        _reach(arm, sent, aside.position)
        sent = arm.send(hasty, calm)
    _reach(arm, sent, position)
    expect_there(sent, position)


def bring_in_haste(arm: WatchedArm, position: Pose) -> None:
    """Bring the arm to a position (rad) at a speed that has to be accepted. Raises CheckFailed."""
    sent = arm.send(goal(position, speed=HASTE), goal(position, speed=CALM))
    expect(
        sent.goal.speed == HASTE,
        expected=f'a goal at {HASTE:g} rad/s to be accepted',
        seen=f'it rejected, and one at {CALM:g} rad/s accepted',
        hint='every speed above 0 is allowed: check goal.speed > 0, and nothing else',
        cause='a goal with a high speed is rejected',
    )
    _reach(arm, sent, position)


def _reach(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    if not arm.time.wait(sent.is_over, seconds=SOON_SEC):
        _wait_longer(arm, sent, position)
    arm.settle()
    arm.start = tuple(position)


def _wait_longer(arm: WatchedArm, sent: SentGoal, position: Pose) -> None:
    if is_under_way(arm, sent, position) and _drives_on(arm, sent):
        return
    if arm.time.wait(sent.is_over, seconds=HASTE_SEC - SOON_SEC):
        return
    is_slow = is_under_way(arm, sent, position)
    if is_slow and arm.time.wait(sent.is_over, seconds=SLOW_SEC):
        return
    seconds = SLOW_SEC + HASTE_SEC if is_slow else HASTE_SEC
    arm.server.fail_without_end(
        sent,
        it=f'it {sent.status} in {seconds:g} s at {sent.goal.speed:g} rad/s',
        none=f'none in {seconds:g} s at {sent.goal.speed:g} rad/s',
        hint=BY_TIME if is_slow else '',
    )


def wait_for_probe(arm: WatchedArm, sent: SentGoal, position: Pose, *, is_free: bool) -> None:
    """Wait for the end of a probe, but not if its feedback shows that it takes too long.

    `is_free`: whether the node answers requests during the move, so that its clock can be driven.
    """
    if arm.time.wait(sent.is_over, seconds=SOON_SEC):
        return
    if is_free and is_under_way(arm, sent, position) and _drives_on(arm, sent):
        return
    if not is_in_vain(sent, free_sec=HASTE_SEC - SOON_SEC):
        arm.time.wait(sent.is_over, seconds=HASTE_SEC - SOON_SEC)


def _drives_on(arm: WatchedArm, sent: SentGoal) -> bool:
    """Drive the robot's clock in haste; return whether that brings a move to its end."""
    if isinstance(arm.time, DrivenTime):
        return arm.time.push(sent.is_over, free_sec=SETTLE_SEC)
    watcher, name = arm.server.watcher, arm.server.node_name
    try:
        with SimulatedClock(watcher, needed={name}) as clock:
            beats = arm.server.ends.feedback.received
            driven = DrivenTime(watcher, clock, step_ns=STEP_NS, beat=lambda: len(beats))
            began_ns = time.time_ns()
            if driven.push(sent.is_over, free_sec=TELLS_SEC):
                return True
            if is_in_vain(sent, free_sec=SETTLE_SEC, since_ns=began_ns):
                return False
            return driven.push(sent.is_over, free_sec=SETTLE_SEC - TELLS_SEC)
    except Inconclusive:
        return False
