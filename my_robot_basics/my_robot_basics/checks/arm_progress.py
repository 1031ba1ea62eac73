"""An arm that is on its way, and slow: that costs the points of its speed, and no others."""

import math
import time

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.arm_results import expect_there
from my_robot_basics.checks.clock import SimulatedClock
from my_robot_basics.checks.inconclusive import Inconclusive
from my_robot_basics.checks.robot_time import DrivenTime
from my_robot_basics.checks.waits_in_vain import is_in_vain
from my_robot_basics.checks.watched_arm import (
    HASTE,
    HASTE_SEC,
    SETTLE_SEC,
    STEP_NS,
    Pose,
    WatchedArm,
    far_rad,
    goal,
)
from my_robot_basics.feedback.errors import expect

BY_TIME = "in each step, move by speed × the time that passed, on the node's own clock"
FEWEST = 4
"""So many messages of feedback show a move. …"""
LATER_PART = 0.25
"""… The later half of them covers this part of the way; in a steady move, half of it. …"""
LATEST_SEC = 1.5
"""… And the last one is no older."""
CALM = 0.5
"""Speed, in rad/s, for a server that rejects HASTE: another check is about that."""
TELLS_SEC = 0.5
"""Of a clock that is driven in haste: then feedback tells whether the arm goes by it."""
ASIDE_RAD = 0.3
"""So far from a position is another one."""
SOON_SEC = 1.0
"""A move in haste that is on its way after that is a slow one."""
SLOW_SEC = 20.0
"""What it may still take on the wall clock."""


def is_under_way(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    """Whether the feedback on a goal tells of an arm that moves on, and is not there yet.

    An arm that slows down all the time never gets there.
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
    """Bring the arm to a position (rad), in haste if the server takes it. Raises CheckFailed.

    It is there then, as far as its result and its feedback tell.
    """
    hasty, calm = goal(position, speed=HASTE), goal(position, speed=CALM)
    aside = goal([each - math.copysign(ASIDE_RAD, each) for each in position], speed=HASTE)
    sent = arm.send(hasty, calm, aside)
    if sent.goal is aside:  # it rejects a goal to where it is: another check is about that
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
    """Wait for the end of a short move that a check has sent, and not in vain if that is long.

    `is_free`: the node answers other questions meanwhile, so that its clock may be driven.
    """
    if arm.time.wait(sent.is_over, seconds=SOON_SEC):
        return
    if is_free and is_under_way(arm, sent, position) and _drives_on(arm, sent):
        return
    if not is_in_vain(sent, free_sec=HASTE_SEC - SOON_SEC):
        arm.time.wait(sent.is_over, seconds=HASTE_SEC - SOON_SEC)


def _drives_on(arm: WatchedArm, sent: SentGoal) -> bool:
    """Whether the robot's clock, driven in haste, brings a move to its end."""
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
