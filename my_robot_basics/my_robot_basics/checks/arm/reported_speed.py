"""The speed of the arm during one move, computed from its feedback."""

from dataclasses import dataclass

import numpy as np

from my_robot_basics.checks.actions.action_ends import SentGoal
from my_robot_basics.checks.arm.watched_arm import Pose, WatchedArm, faster_joint

FEWEST = 4
"""The least number of feedback messages from which a speed is computed."""
MOST = 150
"""The most feedback messages that are compared pairwise, taken evenly from all of them."""
ALIKE = 1e-4
"""Steps that differ by at most this part are constant: not computed from a clock, but added."""
FEWEST_OF_WALL = 3
"""The least number of feedback messages that prove a move by the wall clock."""
WALL_SEC, WALL_PART = 0.3, 0.1
"""A move by the wall clock may differ from it by WALL_SEC plus this part of the time since the
goal was sent."""
STILL_RAD = 1e-6
"""A joint stands still if its position changes by no more between two messages."""
OFTEN = 0.1
"""The quantile of a loop's gaps that is close to its sleep, even on a busy machine."""


@dataclass(frozen=True)
class ReportedSpeed:
    """The speed according to the feedback."""

    rad_per_sec: float
    """The speed of the faster joint; 0 if there is too little feedback during the move."""
    step_sec: float = 0.0
    """The time between the steps of an arm that adds constant steps; otherwise 0."""


def reported_speed(arm: WatchedArm, sent: SentGoal, position: Pose) -> ReportedSpeed:
    """The speed of a move from where the arm was to that position.

    It is the median over all pairs of messages, which a few late ones hardly change. A loop that
    adds constant steps and sleeps between them is different: it is often late and never early, so
    its speed is computed from its short gaps.
    """
    times, ways = _on_the_way(arm, sent, position)
    if len(times) < FEWEST:
        return ReportedSpeed(0.0)
    steps = np.diff(ways)
    if np.ptp(steps) <= ALIKE * abs(float(np.median(steps))) and not arm.time.is_driven:
        step_sec = float(np.quantile(np.diff(times), OFTEN))
        return ReportedSpeed(float(np.median(steps)) / max(step_sec, 1e-9), step_sec)
    some = np.unique(np.linspace(0, len(times) - 1, MOST).astype(int))
    times, ways = times[some], ways[some]
    earlier, later = np.triu_indices(len(times), k=1)
    passed_sec = times[later] - times[earlier]
    is_later = passed_sec > 0.0
    if not is_later.any():
        return ReportedSpeed(0.0)
    gone = ways[later] - ways[earlier]
    return ReportedSpeed(float(np.median(gone[is_later] / passed_sec[is_later])))


@dataclass(frozen=True)
class Rest:
    """How long the faster joint stands still on its way, according to the feedback, in s."""

    sec: float
    """While feedback comes: a busy machine that stops the arm stops its feedback, too."""
    alone_sec: float
    """The part of it in which the other joint moves."""


def rest_of(arm: WatchedArm, sent: SentGoal, position: Pose) -> Rest:
    """How long the faster joint stands still in a move to that position, before its end."""
    found = [
        (arm.time.at_ns(sent_ns) / 1e9, *message.position)
        for sent_ns, message in sent.feedback()
        if len(message.position) == len(position)
    ]
    joint = faster_joint(arm.start, position)
    times, *joints = np.array(found).reshape(-1, 1 + len(position)).T
    with np.errstate(invalid='ignore'):  # a student's node may send inf
        moves = np.abs(np.diff(joints, axis=1)) > STILL_RAD
        is_on_way = np.abs(joints[joint][:-1] - position[joint]) > STILL_RAD
    stands = is_on_way & ~moves[joint]
    passed_sec = np.diff(times)
    alone = stands & moves.any(axis=0)
    return Rest(float(passed_sec[stands].sum()), float(passed_sec[alone].sum()))


def is_of_wall_time(arm: WatchedArm, sent: SentGoal, position: Pose, *, apart_sec: float) -> bool:
    """Whether the feedback follows the wall clock instead of the node's clock.

    The check drives the node's clock, and has held it for more than `apart_sec` since the goal was
    sent. So both clocks differ by more than this afterwards, however busy the machine is.
    """
    own_sec, ways = _on_the_way(arm, sent, position)
    wall_sec, _ = _on_the_way(arm, sent, position, is_wall=True)
    told_sec = ways / sent.goal.speed
    own_sec, wall_sec = own_sec - arm.time.at_ns(sent.sent_ns) / 1e9, wall_sec - sent.sent_ns / 1e9
    is_of_wall = np.abs(told_sec - wall_sec) <= WALL_SEC + WALL_PART * wall_sec
    is_apart = np.abs(told_sec - own_sec) > apart_sec
    has_moved = own_sec > 0.0
    is_enough = np.count_nonzero(is_apart & has_moved) >= FEWEST_OF_WALL
    return bool(is_enough and np.all(is_of_wall[has_moved]))


def _on_the_way(
    arm: WatchedArm, sent: SentGoal, position: Pose, *, is_wall: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """The times of the feedback during the move, in s, and the faster joint's way, in rad."""
    ways = [b - a for a, b in zip(arm.start, position, strict=True)]
    joint = faster_joint(arm.start, position)
    found = []
    for sent_ns, message in sent.feedback():
        if len(message.position) == len(ways):
            part = (message.position[joint] - arm.start[joint]) / ways[joint]
            if 0.0 < part < 1.0:
                at_ns = sent_ns if is_wall else arm.time.at_ns(sent_ns)
                found.append((at_ns / 1e9, part * abs(ways[joint])))
    times, gone = np.array(found).reshape(-1, 2).T
    return times, gone
