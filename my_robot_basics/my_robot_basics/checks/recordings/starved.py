"""Whether a busy machine may be the cause of a wrong rate on the wall clock."""

import numpy as np

from my_robot_basics.checks.recordings import periods
from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages

LATE_SEC = 0.05
"""A recording that the machine delayed by at least this much excuses a delay of the node."""
LATE_TIMES = 3.0
"""The node's delay may be this many times as long, because several of its threads take turns."""
STEADY_PART = 0.05
"""Gaps whose quartiles differ by less than this part of the median are even: nothing delayed the
node."""
RIGHT_PART = 0.02
"""Even gaps are those of the right timer if they differ by at most this part from its period."""
SLOW_PART = 0.04
"""If processes waited for a processor most of the time, even gaps may be longer than the period by
this part: a loop that sleeps is late each time by as much, such as 6 ms of 0.2 s."""
MOST_TIMES = 1.03
"""A busy machine may raise the rate by at most this factor, when late messages come at once."""

NEAR_LEAST = 0.75
"""A rate is nearly right from this part of the expected one to MOST_TIMES: a node that looks at
its clock every 10 ms may publish every 60 ms instead of 50."""


def may_be_starved(recording: RecordedMessages, hz: float) -> bool:
    """Whether a node with the rate `hz` may produce this recording on a busy machine.

    A busy machine makes messages late, each by a different time, but not more frequent. So it
    excuses a pause if it also delayed the recording, by a third of the pause at least; a nearly
    right rate if processes waited for a processor most of the time; and any pause if it left no
    time for the robot's clock. It excuses neither alternating gaps nor even gaps of another
    period, with one exception: without time for the robot's clock, a nearly right rate is always
    excused, because a node that polls its clock is exact only on the robot's.
    """
    messages = recording.messages
    is_near = _is_near(recording, hz)
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


def _is_near(recording: RecordedMessages, hz: float) -> bool:
    """Whether the rate is nearly right; also if only the first gap makes it too high.

    The message at which the recording begins may have been late: then the others seem early.
    """
    rate, later = recording.rate_hz, recording.messages
    if len(later) > 1:
        since_next = (len(later) - 1) / max(later[-1].time_sec - later[0].time_sec, 1e-9)
        rate = min(rate, since_next)
    return recording.rate_hz / hz >= NEAR_LEAST and rate / hz <= MOST_TIMES
