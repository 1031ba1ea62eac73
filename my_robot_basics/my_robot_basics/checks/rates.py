"""When a recording shows a rate, and what to say when it shows another one."""

from typing import TYPE_CHECKING, NoReturn

import numpy as np

from my_robot_basics.checks import periods, pictures, starved
from my_robot_basics.feedback.errors import CheckFailed, Starved, fail

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
"""So much of a period may most messages be off: 0.1 s and 0.3 s by turns are no 5 Hz."""
MOSTLY_PART = 0.1
"""So near to the period are most messages of a node that only pauses now and then."""
TOO_FAST_TIMES = 20.0
"""So many times too fast is no wrong number of seconds: a timer's period of 0."""
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
    times = _times(recording)
    low, high = periods.spanned(times, slack_sec)
    return low <= high and not periods.come_by_turns(times, _slack_sec(recording))


def leaves_out(recording: 'Recording') -> int:
    """Which message of the robot's clock is missing again and again (10: every tenth), or 0."""
    if recording.clock != 'simulated':
        return 0
    return periods.left_out(_times(recording), _slack_sec(recording))


def is_certain(recording: 'Recording') -> bool:
    """Whether the robot's clock has shown a timer, and its period, beyond doubt.

    All messages are equally far apart, or every so many of them is left out, or one period
    explains them and those of the proof, which took other steps: a thread that is late now and
    then is later with coarse steps.
    """
    if recording.clock != 'simulated':
        return False
    if np.ptp(np.diff(_times(recording))) < 0.5 * recording.step_sec or leaves_out(recording):
        return True
    low, high = _certain_range(recording)
    return low <= high


def has_rate(recording: 'Recording', hz: float) -> bool:
    """Whether messages came `hz` times a second, within ±2 %, and evenly.

    On the wall clock that is the period which was meant: a busy machine slows a loop down.
    """
    off = abs(recording.rate_hz / hz - 1.0)
    if recording.clock == 'simulated':
        low, high = _certain_range(recording)
        if low > high:
            low, high = _period_range(recording)
        shortest, longest = (1.0 / (hz * (1.0 + sign * TOLERANCE)) for sign in (1, -1))
        # the mean alone is off by as much as a step
        is_right = off <= TOLERANCE and (low > high or (low <= longest and shortest <= high))
        return is_right and not leaves_out(recording)
    least, most = MEAN_TOLERANCE
    is_meant = abs(_off_meant(recording, hz)) <= TOLERANCE
    return is_meant and least <= recording.rate_hz / hz - 1.0 <= most and is_steady(recording, hz)


def is_steady(recording: 'Recording', hz: float) -> bool:
    """Whether messages on the wall clock came without pauses, and evenly, as `hz` asks for.

    And went on to the end.
    """
    largest = max(LARGEST_GAP_PERIODS / hz, 1.0 / hz + GAP_SLACK_SEC)
    goes_on = recording.largest_gap_sec <= largest and not recording.has_ended
    return goes_on and not _is_uneven(recording, hz)


def is_doubtful(recording: 'Recording', hz: float) -> bool:
    """Whether the period on the wall clock is so near the tolerance that a longer look decides."""
    low, high = DOUBTFUL
    return recording.clock == 'wall' and low < abs(_off_meant(recording, hz)) <= high


def fail_rate(recording: 'Recording', hz: float) -> NoReturn:
    """Raise CheckFailed with the rate that was seen, and a picture of the arrivals."""
    n = len(recording.messages)
    over = f'over {recording.seconds:.3g} s ({n} message{"" if n == 1 else "s"})'
    near = recording.rate_hz >= 0.9 * hz
    if every := leaves_out(recording):
        seen, cause = f'one message of {every} missing each time {over}', 'messages are left out'
        hint = 'publish in every call of the timer'
    elif recording.is_over and (near or n == 0):
        seen, cause = f'none in the last {recording.silent_sec:.1f} s {over}', 'the messages end'
        hint = 'publish as long as the node runs, in each call of a timer'
    elif recording.rate_hz > TOO_FAST_TIMES * hz:
        seen, cause = f'{_hz(recording.rate_hz)} {over}', 'far too many messages'
        hint = 'the timer period is 0, or nearly: period = 1 / rate, and 1 // rate is 0'
    elif (near or _is_mostly(recording, hz)) and (
        recording.largest_gap_sec > LARGEST_GAP_PERIODS / hz
    ):
        seen, cause = f'pauses of {recording.largest_gap_sec:.1f} s {over}', 'there are pauses'
        hint = ONCE
    elif near and recording.clock == 'wall' and _is_uneven(recording, recording.rate_hz):
        gaps = np.diff(_times(recording))
        seen = f'{np.min(gaps):.2f} to {np.max(gaps):.2f} s between messages {over}'
        cause = 'messages alternate between too early and too late'
        hint = 'the messages are unevenly spaced, so use one timer, and do not change its period'
        if np.min(gaps) < AT_ONCE_SEC:
            cause, hint = 'several messages arrive at once', ONCE
    else:
        seen = f'{_hz(_measured_hz(recording, hz))} {over}'
        hint, cause = 'the timer period is in seconds, and period = 1 / rate', 'another rate'
    picture = pictures.arrivals(recording, hz=hz)
    doubt = Starved if starved.may_be(recording, hz) else CheckFailed
    fail(expected=_hz(hz), seen=seen, hint=hint, cause=cause, picture=picture, doubt=doubt)


def _is_mostly(recording: 'Recording', hz: float) -> bool:
    """Whether most messages came one period behind the one before."""
    gaps = np.diff(_times(recording))
    return bool(len(gaps)) and bool(abs(np.median(gaps) * hz - 1.0) <= MOSTLY_PART)


def _measured_hz(recording: 'Recording', hz: float) -> float:
    low, high = _certain_range(recording)
    if low <= high:
        return 2.0 / (low + high)
    if recording.clock == 'wall' and abs(_off_meant(recording, hz)) > TOLERANCE:
        return 1.0 / periods.meant(_times(recording))
    return recording.rate_hz


def _off_meant(recording: 'Recording', hz: float) -> float:
    """How far off is the rate that was meant: 0.01 for one that is 1 % too fast."""
    return 1.0 / (hz * periods.meant(_times(recording))) - 1.0 if recording.messages else -1.0


def _certain_range(recording: 'Recording') -> tuple[float, float]:
    """The periods that explain a recording and its proof; the first above the second: none."""
    if recording.proof is None or not recording.messages or not recording.proof.messages:
        return 1.0, 0.0
    ranges = _period_range(recording), _period_range(recording.proof)
    if any(low > high for low, high in ranges):
        return 1.0, 0.0
    return max(low for low, _ in ranges), min(high for _, high in ranges)


def _is_uneven(recording: 'Recording', hz: float) -> bool:
    """Whether half of the messages, or more, are far from one period behind the one before.

    Or whether they come by turns. On a busy machine one or the other is late, and the next one
    is early.
    """
    times = _times(recording)
    is_far = np.median(np.abs(np.diff(times) * hz - 1.0)) > UNEVEN_PART
    return bool(is_far) or periods.come_by_turns(times)


def _period_range(recording: 'Recording') -> tuple[float, float]:
    return periods.spanned(_times(recording), _slack_sec(recording))


def _slack_sec(recording: 'Recording') -> float:
    return 1.001 * recording.step_sec


def _times(recording: 'Recording') -> np.ndarray:
    return np.array([0.0, *(sample.time_sec for sample in recording.messages)])


def _hz(rate_hz: float) -> str:
    rounded = round(rate_hz, 2)
    return f'{rounded:.1f} Hz' if rounded == round(rounded, 1) else f'{rounded:.2f} Hz'
