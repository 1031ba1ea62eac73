"""Whether a recording has a given rate, and whether that is certain."""

import math

import numpy as np

from my_robot_basics.checks.recordings import periods
from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages

TOLERANCE = 0.02
"""How far a rate may differ from the expected one, as a part of it."""
MEAN_TOLERANCE = -0.05, 0.03
"""How far the mean rate may differ on the wall clock: a busy machine lengthens a loop's sleeps."""
DOUBTFUL = 0.01, 0.04
"""If a rate differs by a part between these two, a recording of 4 s on the wall clock does not
decide: a busy machine may be the cause."""
LARGEST_GAP_PERIODS = 1.75
"""A longer gap between two messages on the wall clock is a pause, in periods of the rate."""
GAP_SLACK_SEC = 0.05
"""How much longer than a period a gap may always be on the wall clock."""
UNEVEN_PART = 0.25
"""How far most gaps may differ from the period, as a part of it: gaps that alternate between 0.1 s
and 0.3 s are not 5 Hz."""
AT_ONCE_SEC = 0.02
"""Messages closer than this were sent at once: no exercise has a timer of a shorter period."""
ONCE = 'publish one message each time the timer fires'
GOES_ON = (
    'publish in each call of a timer, as long as the node runs, and make this timer once, in '
    '__init__'
)
FEWEST = 2
"""How many messages after the first one show whether they are evenly spaced."""


def is_even(recording: RecordedMessages) -> bool:
    """Whether a timer of one period explains every arrival, within a step of the clock."""
    if len(recording.messages) < FEWEST:
        return False
    low, high = _period_range(recording)
    return low <= high


def is_nearly_even(recording: RecordedMessages) -> bool:
    """Whether one period explains every arrival within a quarter of it, or within a step.

    Long and short gaps that alternate are not nearly even.
    """
    slack_sec = max(_slack_sec(recording), UNEVEN_PART / recording.rate_hz)
    times = times_of(recording)
    low, high = periods.possible_periods(times, slack_sec)
    return low <= high and not periods.come_by_turns(times, _slack_sec(recording))


def leaves_out(recording: RecordedMessages) -> int:
    """Which message is missing regularly on the robot's clock (10: every tenth one), or 0."""
    if recording.clock != 'simulated':
        return 0
    return periods.left_out_every(times_of(recording), _slack_sec(recording))


def pattern_of(recording: RecordedMessages) -> periods.Pattern | None:
    """The messages' repeating pattern on the robot's clock that no single timer makes, or None.

    They come several at once, or far from evenly. The proof (the recording with finer steps) must
    show the same pattern: if only a late thread caused it, finer steps make it smaller.
    """
    proof = recording.proof
    if recording.clock != 'simulated' or proof is None:
        return None
    seen, proved = pattern_in(recording), pattern_in(proof)
    if seen is None or proved is None or seen.is_burst != proved.is_burst:
        return None
    times = round(proved.cycle_sec / seen.cycle_sec)
    is_same = proved.size == times * seen.size and math.isclose(
        proved.cycle_sec, times * seen.cycle_sec
    )
    is_no_timers = seen.is_burst or is_uneven(proof, proof.rate_hz, _slack_sec(proof))
    return seen if is_same and is_no_timers else None


def pattern_in(recording: RecordedMessages) -> periods.Pattern | None:
    """The repeating pattern of one recording; the size of its clock steps may have caused it."""
    times_sec, seconds = times_of(recording), recording.seconds
    return periods.pattern_of(times_sec, recording.step_sec, seconds=seconds)


def is_certain(recording: RecordedMessages, hz: float) -> bool:
    """Whether the recording on the robot's clock decides without doubt if a timer has `hz`.

    It does if all gaps are equal, if messages are left out regularly, if they have a pattern that
    no timer makes, or if one period that is not that of `hz` explains both the recording and its
    proof, which has other steps (a late thread is later with coarse steps). If the period of `hz`
    explains them, too, and yet the mean is off, the first or last message may have been late.
    """
    if recording.clock != 'simulated':
        return False
    if np.ptp(np.diff(times_of(recording))) < 0.5 * recording.step_sec:
        return True
    if leaves_out(recording) or pattern_of(recording):
        return True
    low, high = certain_range(recording)
    return low <= high and not _holds(low, high, hz)


def has_rate(recording: RecordedMessages, hz: float) -> bool:
    """Whether messages came at `hz`, within ±2 %, and evenly.

    On the wall clock, the ±2 % are of the period that the timer or loop was given (see
    `periods.intended_period`), and MEAN_TOLERANCE is that of the mean: a busy machine slows a loop
    down.
    """
    off = abs(recording.rate_hz / hz - 1.0)
    if recording.clock == 'simulated':
        low, high = certain_range(recording)
        if low > high:
            low, high = _period_range(recording)
        # the mean is not exact enough by itself: it may be off by a step
        is_right = off <= TOLERANCE and (low > high or _holds(low, high, hz))
        goes_on = not recording.is_over and not leaves_out(recording)
        return is_right and goes_on and not pattern_of(recording)
    least, most = MEAN_TOLERANCE
    is_meant = abs(off_intended(recording, hz)) <= TOLERANCE
    return is_meant and least <= recording.rate_hz / hz - 1.0 <= most and is_steady(recording, hz)


def _holds(low: float, high: float, hz: float) -> bool:
    """Whether the range of periods from `low` to `high` (in s) includes that of `hz`, ±2 %."""
    shortest, longest = (1.0 / (hz * (1.0 + sign * TOLERANCE)) for sign in (1, -1))
    return low <= longest and shortest <= high


def is_steady(recording: RecordedMessages, hz: float) -> bool:
    """Whether messages came evenly at about `hz`, without pauses, until the recording's end.

    For recordings on the wall clock.
    """
    largest = max(LARGEST_GAP_PERIODS / hz, 1.0 / hz + GAP_SLACK_SEC)
    goes_on = recording.largest_gap_sec <= largest and not recording.has_ended
    return goes_on and not is_uneven(recording, hz)


def is_doubtful(recording: RecordedMessages, hz: float) -> bool:
    """Whether a longer recording is needed: the wall clock's period is close to the tolerance."""
    low, high = DOUBTFUL
    return recording.clock == 'wall' and low < abs(off_intended(recording, hz)) <= high


def off_intended(recording: RecordedMessages, hz: float) -> float:
    """How far the rate of `periods.intended_period` is from `hz`: 0.01 if it is 1 % too fast."""
    return (
        1.0 / (hz * periods.intended_period(times_of(recording))) - 1.0
        if recording.messages
        else -1.0
    )


def certain_range(recording: RecordedMessages) -> tuple[float, float]:
    """The least and greatest period (s) that explain both a recording and its proof.

    The first is above the second if no period does.
    """
    if recording.proof is None or not recording.messages or not recording.proof.messages:
        return 1.0, 0.0
    ranges = _period_range(recording), _period_range(recording.proof)
    if any(low > high for low, high in ranges):
        return 1.0, 0.0
    return max(low for low, _ in ranges), min(high for _, high in ranges)


def is_uneven(recording: RecordedMessages, hz: float, slack_sec: float = 0.0) -> bool:
    """Whether at least half of the gaps are far from the period of `hz`, or the gaps alternate.

    A busy machine makes single messages late, and thus the gap after them short; that is not
    uneven. `slack_sec`: how far a message may be off without a fault of its node.
    """
    times = times_of(recording)
    is_far = np.median(np.abs(np.diff(times) * hz - 1.0)) > UNEVEN_PART + slack_sec * hz
    return bool(is_far) or periods.come_by_turns(times, slack_sec)


def times_of(recording: RecordedMessages) -> np.ndarray:
    """Arrival times in s, first the 0.0 of the message at which it begins: shape (n + 1,)."""
    return np.array([0.0, *(sample.time_sec for sample in recording.messages)])


def _period_range(recording: RecordedMessages) -> tuple[float, float]:
    return periods.possible_periods(times_of(recording), _slack_sec(recording))


def _slack_sec(recording: RecordedMessages) -> float:
    return 1.001 * recording.step_sec
