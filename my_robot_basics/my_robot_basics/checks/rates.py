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


def is_even(recording: 'Recording') -> bool:
    """Whether a timer of one period explains every arrival, within a step of the clock."""
    times = _times(recording)
    if len(times) < 3:
        return False
    earlier, later = np.triu_indices(len(times), k=1)
    periods, apart = times[later] - times[earlier], later - earlier
    # each pair of arrivals leaves the period a range; they must all agree on one
    slack = 1.001 * recording.step_sec
    return bool(np.max((periods - slack) / apart) <= np.min((periods + slack) / apart))


def is_regular(recording: 'Recording') -> bool:
    """Whether the robot's clock shows all messages equally far apart."""
    if recording.clock != 'simulated':
        return False
    return bool(np.ptp(np.diff(_times(recording))) < 0.5 * recording.step_sec)


def has_rate(recording: 'Recording', hz: float) -> bool:
    """Whether messages came `hz` times a second: ±2 % simulated, ±3 % and evenly on the wall."""
    off = abs(recording.rate_hz / hz - 1.0)
    if recording.clock == 'simulated':
        return off <= SIMULATED_TOLERANCE
    largest = max(LARGEST_GAP_PERIODS / hz, 1.0 / hz + GAP_SLACK_SEC)
    return off <= WALL_TOLERANCE and recording.largest_gap_sec <= largest


def fail_rate(recording: 'Recording', hz: float) -> NoReturn:
    """Raise CheckFailed with the rate that was seen, and a picture of the arrivals."""
    n = len(recording.messages)
    over = f'over {recording.seconds:g} s ({n} message{"" if n == 1 else "s"})'
    if recording.rate_hz >= 0.9 * hz and recording.largest_gap_sec > LARGEST_GAP_PERIODS / hz:
        seen = f'pauses of {recording.largest_gap_sec:.1f} s {over}'
        hint = 'publish one message each time the timer fires'
    else:
        seen = f'{_hz(recording.rate_hz)} {over}'
        hint = 'the timer period is in seconds, and period = 1 / rate'
    fail(expected=_hz(hz), seen=seen, hint=hint, picture=pictures.arrivals(recording, hz=hz))


def _times(recording: 'Recording') -> np.ndarray:
    return np.array([0.0, *(sample.time_sec for sample in recording.messages)])


def _hz(rate_hz: float) -> str:
    rounded = round(rate_hz, 2)
    return f'{rounded:.1f} Hz' if rounded == round(rounded, 1) else f'{rounded:.2f} Hz'
