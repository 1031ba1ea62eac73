"""The speed of the arm on one move, as its feedback tells it."""

from dataclasses import dataclass

import numpy as np

from my_robot_basics.checks.action_ends import SentGoal
from my_robot_basics.checks.watched_arm import Pose, WatchedArm

FEWEST = 4
"""So much feedback tells a speed; of more than MOST messages, as many are looked at."""
MOST = 150
ALIKE = 1e-4
"""So much of a step may two steps differ that were added, and not computed from a clock."""
WALL_PART = 0.25
"""So near to the speed on the wall clock is none that a driven clock makes by chance."""
OFTEN = 0.1
"""So many of a loop's gaps are hardly longer than it was to sleep, on a busy machine, too."""


@dataclass(frozen=True)
class ReportedSpeed:
    """What the feedback tells."""

    rad_per_sec: float
    """Of the faster joint; 0 where there is too little feedback on the way."""
    step_sec: float = 0.0
    """How long a step takes of an arm that adds one step to the other; else 0."""


def reported_speed(arm: WatchedArm, sent: SentGoal, position: Pose) -> ReportedSpeed:
    """The speed of a move from where the arm was to that position.

    The median over all pairs of messages: one that is late hardly moves it. A loop that adds up
    steps and sleeps between them is late with many, and early with none: its short gaps tell.
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


def is_of_wall_time(arm: WatchedArm, sent: SentGoal, position: Pose) -> bool:
    """Whether the feedback has the speed that was asked for on the wall clock, and not on its own.

    So it is where the time that has passed is that of another clock than the node's.
    """
    if not arm.time.is_driven:
        return False
    times, ways = _on_the_way(arm, sent, position, is_wall=True)
    if len(times) < FEWEST or times[-1] <= times[0]:
        return False
    speed = (ways[-1] - ways[0]) / (times[-1] - times[0])
    return bool(abs(speed / sent.goal.speed - 1.0) <= WALL_PART)


def _on_the_way(
    arm: WatchedArm, sent: SentGoal, position: Pose, *, is_wall: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """When the feedback came, in s, and how far the faster joint had gone then, in rad."""
    ways = [b - a for a, b in zip(arm.start, position, strict=True)]
    joint = max(range(len(ways)), key=lambda number: abs(ways[number]))
    found = []
    for sent_ns, message in sent.feedback():
        if len(message.position) == len(ways):
            part = (message.position[joint] - arm.start[joint]) / ways[joint]
            if 0.0 < part < 1.0:
                at_ns = sent_ns if is_wall else arm.time.at_ns(sent_ns)
                found.append((at_ns / 1e9, part * abs(ways[joint])))
    times, gone = np.array(found).reshape(-1, 2).T
    return times, gone
