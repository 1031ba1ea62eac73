"""Whether a machine that is too busy may be to blame for a rate on the wall clock."""

from typing import TYPE_CHECKING

import numpy as np

from my_robot_basics.checks import periods

if TYPE_CHECKING:
    from my_robot_basics.checks.recording import Recording

LATE_SEC = 0.05
"""A machine that keeps the recording waiting so long …"""
LATE_TIMES = 3.0
"""… may keep a node waiting so many times as long: several of its threads take turns."""
STEADY_PART = 0.05
"""Gaps that differ by no more of them are those of a node that nobody kept waiting."""
RIGHT_PART = 0.02
"""Even gaps that are off by no more of a period are those of the right timer. …"""
SLOW_PART = 0.04
"""… Where processes wait for a processor all the time, a loop that sleeps is late each time, and
as evenly: by 6 ms of 0.2 s, with eight processes for each processor."""
MOST_TIMES = 1.03
"""So many times as many messages may a busy machine bring: those that were late, at once."""

NEAR_LEAST = 0.75
"""… and so many times as many are nearly right: a look every 10 ms makes 60 ms of 50."""


def may_be(recording: 'Recording', hz: float) -> bool:
    """Whether a node of that rate may have been kept waiting for what was recorded.

    A machine that is too busy makes messages late, each by another time, and no more of them. How
    much is told by how late the recording itself was; alternating gaps, or gaps as even as with a
    timer of another period, are no machine's doing, but a pause of the right one may be. Where
    processes waited for a processor most of the time, a rate that is nearly right is no proof
    either; and where there was no time for the robot's clock, not even an
    even one: a node that looks at its clock again and again is exact on that one alone. Such a
    machine may bring any pause, too.
    """
    messages = recording.messages
    is_near = NEAR_LEAST <= recording.rate_hz / hz <= MOST_TIMES
    if recording.clock != 'wall' or not messages:
        return False
    if recording.is_makeshift and is_near:
        return True
    times = np.array([0.0, *(sample.time_sec for sample in messages)])
    gaps = np.diff(times)
    often, seldom = np.quantile(gaps, [0.25, 0.75])
    median_sec = float(np.median(gaps))
    is_steady = seldom - often < STEADY_PART * median_sec
    most = SLOW_PART if recording.was_busy else RIGHT_PART
    is_another = is_steady and not -RIGHT_PART <= median_sec * hz - 1.0 <= most
    late_sec, longest_sec = recording.late_sec, recording.largest_gap_sec - 1.0 / hz
    is_late = late_sec >= LATE_SEC and longest_sec <= LATE_TIMES * late_sec
    is_slow = recording.rate_hz <= MOST_TIMES * hz
    is_makeshift = recording.is_makeshift
    is_excused = (is_slow and (is_late or is_makeshift)) or (recording.was_busy and is_near)
    return bool(is_excused and not is_another and not periods.come_by_turns(times))
