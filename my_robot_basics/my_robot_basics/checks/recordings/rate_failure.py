"""The failure message for a recording that does not have the expected rate."""

from typing import NoReturn

import numpy as np

from my_robot_basics.checks.recordings import periods, pictures, rates, starved
from my_robot_basics.checks.recordings.recorded_messages import RecordedMessages
from my_robot_basics.checks.recordings.sleeping_callbacks import why_too_slow
from my_robot_basics.feedback.errors import CheckFailed, Starved, fail

MOSTLY_PART = 0.1
"""If a node only pauses sometimes, the median gap differs from the period by at most this part."""
TOO_FAST_TIMES = 20.0
"""A rate more than this many times too high comes from a timer with a period of (almost) 0, or
from ever more timers, not from a wrong number of seconds."""
EXTRA_LEAST = 2
"""So many messages at once with another one are no delay of a busy machine."""
AT_ONCE = 'several messages arrive at once'


def fail_rate(recording: RecordedMessages, hz: float) -> NoReturn:
    """Raise CheckFailed with the rate of the recording and a picture of the arrivals."""
    seen, cause, hint = _explanation(recording, hz)
    hint = why_too_slow(recording, hz) or hint
    picture = pictures.plot_arrivals(recording, hz=hz)
    doubt = Starved if starved.may_be_starved(recording, hz) else CheckFailed
    expected = f'{_rounded(hz)} Hz on {recording.topic_name}'
    fail(expected=expected, seen=seen, hint=hint, cause=cause, picture=picture, doubt=doubt)


def _explanation(recording: RecordedMessages, hz: float) -> tuple[str, str, str]:
    """Return what was seen, its cause, and what to try, for the first fault that fits."""
    over = f'over {recording.seconds:.3g} s ({_messages(recording)})'
    if every := rates.leaves_out(recording):
        seen, cause = f'one message of {every} missing each time {over}', 'messages are left out'
        return seen, cause, 'publish in every call of the timer'
    pattern = rates.pattern_of(recording)
    if pattern and pattern.is_burst:
        seen = f'{pattern.size} messages at once, every {pattern.cycle_sec:.3g} s, {over}'
        return seen, AT_ONCE, rates.ONCE
    if recording.rate_hz > TOO_FAST_TIMES * hz:
        # this comes before pauses: a node may pause because it is busy with so many messages
        seen, cause = _hz_over(recording, recording.rate_hz), 'far too many messages'
        hint = (
            'the timer period is 0, or nearly (period = 1 / rate, and 1 // rate is 0), or a'
            ' callback publishes in a loop, or each call of the timer makes another timer: make'
            ' one, in __init__, and publish once in each of its calls'
        )
        return seen, cause, hint
    if _has_extra(recording, hz):
        seen = f'{_rounded(recording.rate_hz)} Hz {over}, and several messages at once'
        return seen, AT_ONCE, rates.ONCE
    near = recording.rate_hz >= 0.9 * hz
    if recording.is_over and (near or not recording.messages):
        if recording.messages:
            seen = f'none in the last {recording.silent_sec:.1f} s {over}'
        else:  # they came before this recording, which is a second look
            seen = f'some, and none any more over {recording.seconds:.3g} s'
        return seen, 'the messages end', rates.GOES_ON
    has_pauses = recording.largest_gap_sec > rates.LARGEST_GAP_PERIODS / hz
    if has_pauses and (near or _is_mostly(recording, hz)):
        seen, cause = f'pauses of {recording.largest_gap_sec:.1f} s {over}', 'there are pauses'
        return seen, cause, rates.ONCE
    if near and (pattern or _is_uneven(recording) or _is_right_in_words(recording, hz)):
        gaps = np.diff(rates.times_of(recording))
        seen = f'{np.min(gaps):.2f} to {np.max(gaps):.2f} s between messages {over}'
        if np.min(gaps) < rates.AT_ONCE_SEC:
            return seen, AT_ONCE, rates.ONCE
        cause = 'messages alternate between too early and too late'
        hint = 'the messages are unevenly spaced, so use one timer, and do not change its period'
        return seen, cause, hint
    seen, cause = _hz_over(recording, _measured_hz(recording, hz)), 'another rate'
    return seen, cause, 'the timer period is in seconds, and period = 1 / rate'


def _has_extra(recording: RecordedMessages, hz: float) -> bool:
    """Whether the rate is right without the messages that come at once with another one."""
    gaps = np.diff(rates.times_of(recording))
    extra = int(np.sum(gaps < rates.AT_ONCE_SEC))
    others = recording.rate_hz * (1.0 - extra / max(len(gaps), 1))
    is_right = abs(others / hz - 1.0) <= rates.TOLERANCE
    return extra >= EXTRA_LEAST and is_right and _is_mostly(recording, hz)


def _is_right_in_words(recording: RecordedMessages, hz: float) -> bool:
    """Whether the measured rate and the expected one are the same text once rounded."""
    return _hz(_measured_hz(recording, hz)) == _hz(hz)


def _is_uneven(recording: RecordedMessages) -> bool:
    return recording.clock == 'wall' and rates.is_uneven(recording, recording.rate_hz)


def _is_mostly(recording: RecordedMessages, hz: float) -> bool:
    """Whether most messages came one period after the one before."""
    gaps = np.diff(rates.times_of(recording))
    return bool(len(gaps)) and bool(abs(np.median(gaps) * hz - 1.0) <= MOSTLY_PART)


def _measured_hz(recording: RecordedMessages, hz: float) -> float:
    low, high = rates.certain_range(recording)
    if low <= high:
        return 2.0 / (low + high)
    if recording.clock == 'wall' and abs(rates.off_intended(recording, hz)) > rates.TOLERANCE:
        return 1.0 / periods.intended_period(rates.times_of(recording))
    return recording.rate_hz


def _hz_over(recording: RecordedMessages, rate_hz: float) -> str:
    return f'{_rounded(rate_hz)} Hz over {recording.seconds:.3g} s ({_messages(recording)})'


def _messages(recording: RecordedMessages) -> str:
    n = len(recording.messages)
    return f'{n} message{"" if n == 1 else "s"}'


def _hz(rate_hz: float) -> str:
    return f'{_rounded(rate_hz)} Hz'


def _rounded(rate_hz: float) -> str:
    rounded = round(rate_hz, 2)
    return f'{rounded:.1f}' if rounded == round(rounded, 1) else f'{rounded:.2f}'
