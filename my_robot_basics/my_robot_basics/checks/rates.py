"""When a recording shows a rate."""

import math
from typing import TYPE_CHECKING

import numpy as np

from my_robot_basics.checks import periods

if TYPE_CHECKING:
    from my_robot_basics.checks.recording import Recording

TOLERANCE = 0.02
MEAN_TOLERANCE = -0.05, 0.03
"""So much may the mean be off on the wall clock: a busy machine adds to each sleep of a loop."""
DOUBTFUL = 0.01, 0.04
"""Off by more, and by no more than that: 4 s of a busy machine do not decide it."""
LARGEST_GAP_PERIODS = 1.75
"""More between two messages (on the wall clock) is a pause: bursts are not a rate."""
SILENT_PERIODS = 2.75
"""More at the end tells that none comes any more: the last message may be on its way."""
LONGER_PAUSE = 1.5
GAP_SLACK_SEC = 0.05
UNEVEN_PART = 0.25
"""How much of a period most messages may be off: 0.1 s and 0.3 s alternating are no 5 Hz."""
AT_ONCE_SEC = 0.02
"""Nobody's timer means two messages so near to each other."""
ONCE = 'publish one message each time the timer fires'
FEWEST = 2
"""Messages that tell whether they are evenly spaced, beside the one to begin at."""


def is_even(recording: 'Recording') -> bool:
    """Whether a timer of one period explains every arrival, within a step of the clock."""
    if len(recording.messages) < FEWEST:
        return False
    low, high = _period_range(recording)
    return low <= high


def is_nearly_even(recording: 'Recording') -> bool:
    """Whether it does so within a quarter of that period, or a step, and without any turns."""
    slack_sec = max(_slack_sec(recording), UNEVEN_PART / recording.rate_hz)
    times = times_of(recording)
    low, high = periods.spanned(times, slack_sec)
    return low <= high and not periods.come_by_turns(times, _slack_sec(recording))


def leaves_out(recording: 'Recording') -> int:
    """Which message of the robot's clock is missing again and again (10: every tenth), or 0."""
    if recording.clock != 'simulated':
        return 0
    return periods.left_out(times_of(recording), _slack_sec(recording))


def pattern_of(recording: 'Recording') -> periods.Pattern | None:
    """The pattern of messages on the robot's clock that no timer makes, whatever its period.

    They come at once, or far from evenly. The proof has to show the same: a thread that is late is
    less so with finer steps.
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


def pattern_in(recording: 'Recording') -> periods.Pattern | None:
    """The pattern that these steps of the robot's clock show, though they may have made it."""
    times_sec, seconds = times_of(recording), recording.seconds
    return periods.pattern_of(times_sec, recording.step_sec, seconds=seconds)


def is_certain(recording: 'Recording', hz: float) -> bool:
    """Whether the robot's clock has shown beyond doubt whether a timer sends `hz` a second.

    All messages are equally far apart, or every so many of them is left out, or they come in a
    pattern that no timer makes, or one period explains them and those of the proof, which took
    other steps: a thread that is late now and then is later with coarse steps. Where that may be
    the period of `hz`, and the mean is off, the first message may have been late, or the last.
    """
    if recording.clock != 'simulated':
        return False
    if np.ptp(np.diff(times_of(recording))) < 0.5 * recording.step_sec:
        return True
    if leaves_out(recording) or pattern_of(recording):
        return True
    low, high = certain_range(recording)
    return low <= high and not _holds(low, high, hz)


def has_rate(recording: 'Recording', hz: float) -> bool:
    """Whether messages came `hz` times a second, within ±2 %, and evenly.

    On the wall clock that is the period which was meant: a busy machine slows a loop down.
    """
    off = abs(recording.rate_hz / hz - 1.0)
    if recording.clock == 'simulated':
        low, high = certain_range(recording)
        if low > high:
            low, high = _period_range(recording)
        # the mean alone is off by as much as a step
        is_right = off <= TOLERANCE and (low > high or _holds(low, high, hz))
        goes_on = not recording.is_over and not leaves_out(recording)
        return is_right and goes_on and not pattern_of(recording)
    least, most = MEAN_TOLERANCE
    is_meant = abs(off_meant(recording, hz)) <= TOLERANCE
    return is_meant and least <= recording.rate_hz / hz - 1.0 <= most and is_steady(recording, hz)


def _holds(low: float, high: float, hz: float) -> bool:
    """Whether one of these periods, in seconds, is that of `hz`, within ±2 %."""
    shortest, longest = (1.0 / (hz * (1.0 + sign * TOLERANCE)) for sign in (1, -1))
    return low <= longest and shortest <= high


def is_steady(recording: 'Recording', hz: float) -> bool:
    """Whether messages on the wall clock came without pauses, and evenly, as `hz` asks for.

    And went on to the end.
    """
    largest = max(LARGEST_GAP_PERIODS / hz, 1.0 / hz + GAP_SLACK_SEC)
    goes_on = recording.largest_gap_sec <= largest and not recording.has_ended
    return goes_on and not is_uneven(recording, hz)


def is_doubtful(recording: 'Recording', hz: float) -> bool:
    """Whether the period on the wall clock is so near the tolerance that a longer look decides."""
    low, high = DOUBTFUL
    return recording.clock == 'wall' and low < abs(off_meant(recording, hz)) <= high


def off_meant(recording: 'Recording', hz: float) -> float:
    """How far off is the rate that was meant: 0.01 for one that is 1 % too fast."""
    return 1.0 / (hz * periods.meant(times_of(recording))) - 1.0 if recording.messages else -1.0


def certain_range(recording: 'Recording') -> tuple[float, float]:
    """The periods that explain a recording and its proof; the first above the second: none."""
    if recording.proof is None or not recording.messages or not recording.proof.messages:
        return 1.0, 0.0
    ranges = _period_range(recording), _period_range(recording.proof)
    if any(low > high for low, high in ranges):
        return 1.0, 0.0
    return max(low for low, _ in ranges), min(high for _, high in ranges)


def is_uneven(recording: 'Recording', hz: float, slack_sec: float = 0.0) -> bool:
    """Whether half of the messages, or more, are far from one period behind the one before.

    Or whether their gaps alternate. On a busy machine one or the other is late, and the next one
    is early. `slack_sec`: how far off a message may be for no fault of its node.
    """
    times = times_of(recording)
    is_far = np.median(np.abs(np.diff(times) * hz - 1.0)) > UNEVEN_PART + slack_sec * hz
    return bool(is_far) or periods.come_by_turns(times, slack_sec)


def times_of(recording: 'Recording') -> np.ndarray:
    """When its messages came, in seconds, with the one at which it begins: shape (n + 1,)."""
    return np.array([0.0, *(sample.time_sec for sample in recording.messages)])


def _period_range(recording: 'Recording') -> tuple[float, float]:
    return periods.spanned(times_of(recording), _slack_sec(recording))


def _slack_sec(recording: 'Recording') -> float:
    return 1.001 * recording.step_sec
