"""When a recording shows a rate, and what to say when it shows another one."""

from typing import TYPE_CHECKING, NoReturn

import numpy as np

from my_robot_basics.checks import pictures
from my_robot_basics.checks.errors import fail

if TYPE_CHECKING:
    from my_robot_basics.checks.recording import Recording

SIMULATED_TOLERANCE = 0.02
WALL_TOLERANCE = 0.03
LARGEST_GAP_PERIODS = 1.75
"""More between two messages (on the wall clock) is a pause: bursts are not a rate."""
GAP_SLACK_SEC = 0.05
UNEVEN_PART = 0.25
"""So much of a period may most messages be off: 0.1 s and 0.3 s by turns are no 5 Hz."""
AT_ONCE_SEC = 0.02
"""Nobody's timer means two messages so near to each other."""
ONCE = 'publish one message each time the timer fires'
FEWEST = 2
"""Messages that tell whether they are evenly spaced, beside the one to begin at."""


def is_even(recording: 'Recording') -> bool:
    """Whether a timer of one period explains every arrival, within a step of the clock."""
    if len(recording.messages) < FEWEST:
        return False
    low, high = period_range(recording)
    return low <= high


def is_nearly_even(recording: 'Recording') -> bool:
    """Whether it does so within a quarter of that period, or within a step of the clock."""
    slack_sec = max(_slack_sec(recording), UNEVEN_PART / recording.rate_hz)
    low, high = period_range(recording, slack_sec)
    return low <= high


def period_range(recording: 'Recording', slack_sec: float | None = None) -> tuple[float, float]:
    """The least and the greatest period, in seconds, of a timer that explains every arrival.

    Each may be so late (by default a step of the clock). The least is above the greatest where
    none explains them.
    """
    slack_sec = _slack_sec(recording) if slack_sec is None else slack_sec
    times = _times(recording)
    earlier, later = np.triu_indices(len(times), k=1)
    periods, apart = times[later] - times[earlier], later - earlier
    # each pair of arrivals leaves the period a range; they must all agree on one
    low, high = (periods - slack_sec) / apart, (periods + slack_sec) / apart
    return float(np.max(low)), float(np.min(high))


def is_certain(recording: 'Recording') -> bool:
    """Whether the robot's clock has shown a timer, and its period, beyond doubt.

    All messages are equally far apart, or one period explains them and those of the proof, which
    took other steps: a thread that is late now and then is later with coarse steps.
    """
    if recording.clock != 'simulated':
        return False
    if np.ptp(np.diff(_times(recording))) < 0.5 * recording.step_sec:
        return True
    low, high = _certain_range(recording)
    return low <= high


def has_rate(recording: 'Recording', hz: float) -> bool:
    """Whether messages came `hz` times a second: ±2 % simulated, ±3 % and evenly on the wall."""
    off = abs(recording.rate_hz / hz - 1.0)
    if recording.clock == 'simulated':
        low, high = _certain_range(recording)
        if low > high:
            low, high = period_range(recording)
        shortest, longest = (1.0 / (hz * (1.0 + sign * SIMULATED_TOLERANCE)) for sign in (1, -1))
        # the mean alone is off by as much as a step
        return off <= SIMULATED_TOLERANCE and (low > high or (low <= longest and shortest <= high))
    largest = max(LARGEST_GAP_PERIODS / hz, 1.0 / hz + GAP_SLACK_SEC)
    is_steady = recording.largest_gap_sec <= largest and not _is_uneven(recording, hz)
    return off <= WALL_TOLERANCE and is_steady


def fail_rate(recording: 'Recording', hz: float) -> NoReturn:
    """Raise CheckFailed with the rate that was seen, and a picture of the arrivals."""
    n = len(recording.messages)
    over = f'over {recording.seconds:.3g} s ({n} message{"" if n == 1 else "s"})'
    near = recording.rate_hz >= 0.9 * hz
    if near and recording.largest_gap_sec > LARGEST_GAP_PERIODS / hz:
        seen, cause = f'pauses of {recording.largest_gap_sec:.1f} s {over}', 'there are pauses'
        hint = ONCE
    elif near and recording.clock == 'wall' and _is_uneven(recording, recording.rate_hz):
        gaps = np.diff(_times(recording))
        seen = f'{np.min(gaps):.2f} to {np.max(gaps):.2f} s between messages {over}'
        cause = 'messages come too early and too late by turns'
        hint = 'the messages are unevenly spaced, so use one timer, and leave its period as it is'
        if np.min(gaps) < AT_ONCE_SEC:
            cause, hint = 'several messages come at once', ONCE
    else:
        seen = f'{_hz(_measured_hz(recording))} {over}'
        hint, cause = 'the timer period is in seconds, and period = 1 / rate', 'another rate'
    picture = pictures.arrivals(recording, hz=hz)
    fail(expected=_hz(hz), seen=seen, hint=hint, cause=cause, picture=picture)


def _measured_hz(recording: 'Recording') -> float:
    low, high = _certain_range(recording)
    return 2.0 / (low + high) if low <= high else recording.rate_hz


def _certain_range(recording: 'Recording') -> tuple[float, float]:
    """The periods that explain a recording and its proof; the first above the second: none."""
    if recording.proof is None or not recording.messages or not recording.proof.messages:
        return 1.0, 0.0
    ranges = period_range(recording), period_range(recording.proof)
    if any(low > high for low, high in ranges):
        return 1.0, 0.0
    return max(low for low, _ in ranges), min(high for _, high in ranges)


def _is_uneven(recording: 'Recording', hz: float) -> bool:
    """Whether half of the messages, or more, are far from one period behind the one before.

    On a busy machine one or the other is late, and the next one is early.
    """
    gaps = np.diff(_times(recording))
    return bool(np.median(np.abs(gaps * hz - 1.0)) > UNEVEN_PART)


def _slack_sec(recording: 'Recording') -> float:
    return 1.001 * recording.step_sec


def _times(recording: 'Recording') -> np.ndarray:
    return np.array([0.0, *(sample.time_sec for sample in recording.messages)])


def _hz(rate_hz: float) -> str:
    rounded = round(rate_hz, 2)
    return f'{rounded:.1f} Hz' if rounded == round(rounded, 1) else f'{rounded:.2f} Hz'
