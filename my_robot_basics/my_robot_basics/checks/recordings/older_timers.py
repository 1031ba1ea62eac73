"""A rate that is too high because the timers of earlier changes still run."""

from collections.abc import Sequence

from my_robot_basics.checks.recordings.rate_failure import AT_ONCE
from my_robot_basics.feedback.errors import CheckFailed, cause_of, fail

NEAR_PART = 0.1
"""Two rates count as the same if they differ by at most this part."""


def are_near(rate_hz: float, other_hz: float, *, part: float = NEAR_PART) -> bool:
    """Whether two rates count as the same."""
    return abs(rate_hz - other_hz) <= part * other_hz


def expect_none(
    name: str, seen_hz: float, taken_hz: Sequence[float], *, failed: CheckFailed
) -> None:
    """Raise CheckFailed if the timers of all values that were set, the last of them now, run.

    `failed` says what is wrong with the rate. On a busy machine, so many timers have no certain
    rate; but a node that sent one message at a time before a change does not send several later.
    """
    *earlier, now_hz = taken_hz
    if len(earlier) < 2:
        return
    is_sum = are_near(seen_hz, sum(taken_hz))
    if is_sum or (cause_of(failed) == AT_ONCE and seen_hz > (1.0 + NEAR_PART) * now_hz):
        seen = f'{seen_hz:.3g} Hz, and several messages at once'
        if is_sum:
            seen = f'{seen_hz:.3g} Hz, which is all rates since the start together'
        fail(
            expected=f'{now_hz:g} Hz after {name} was set to it',
            seen=seen,
            hint='store each new timer as self.timer, so that the next change can destroy it',
            cause='the timers of earlier changes still run',
            doubt=type(failed),
        )
