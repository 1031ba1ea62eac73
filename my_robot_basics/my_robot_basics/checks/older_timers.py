"""A rate that is too high because the timers of earlier changes still run."""

from collections.abc import Sequence

from my_robot_basics.feedback.errors import CheckFailed, fail

NEAR_PART = 0.1
"""Two rates count as the same if they differ by at most this part."""


def are_near(rate_hz: float, other_hz: float, *, part: float = NEAR_PART) -> bool:
    """Whether two rates count as the same."""
    return abs(rate_hz - other_hz) <= part * other_hz


def expect_none(
    name: str, seen_hz: float, taken_hz: Sequence[float], *, doubt: type[CheckFailed]
) -> None:
    """The rate is not that of all values that were set, the last of them now, together.

    Raises CheckFailed.
    """
    *earlier, now_hz = taken_hz
    if len(earlier) > 1 and are_near(seen_hz, sum(taken_hz)):
        fail(
            expected=f'{now_hz:g} Hz after {name} was set to it',
            seen=f'{seen_hz:.3g} Hz, which is all rates since the start together',
            hint='store each new timer as self.timer, so that the next change can destroy it',
            cause='the timers of earlier changes still run',
            doubt=doubt,
        )
