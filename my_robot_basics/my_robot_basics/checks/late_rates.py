"""A rate that a node takes on too late after its parameter was set."""

import itertools

import numpy as np

from my_robot_basics.checks import rates
from my_robot_basics.checks.recording import Recording
from my_robot_basics.feedback.errors import expect

SOON_SEC = 0.5
"""How long a node may keep its former rate, in seconds of the robot's time, beside one period: it
may look at its parameter every so often, or before it publishes the next message."""
NEAR_PART = 0.1
"""How far a gap may differ from a period, as a part of it, beside a step of the clock."""
FEWEST = 3
"""How many messages have to come at the new rate afterwards."""


def expect_soon(recording: Recording, name: str, before_hz: float, now_hz: float) -> None:
    """Expect no change from one rate to the other long after `name` was set. Raises CheckFailed.

    Such a change made the recording before uneven: first there are gaps of the one rate, and then
    of the other. A busy machine makes no such gaps on the robot's clock.
    """
    if recording.uneven is None:
        return
    gaps_sec = np.diff(rates.times_of(recording.uneven)).tolist()
    step_sec = recording.uneven.step_sec

    def are_of(rate_hz: float, gaps_sec: list[float]) -> list[float]:
        slack_sec = NEAR_PART / rate_hz + step_sec
        near = itertools.takewhile(lambda gap: abs(gap - 1.0 / rate_hz) <= slack_sec, gaps_sec)
        return list(near)

    former = are_of(before_hz, gaps_sec)
    later = are_of(now_hz, gaps_sec[len(former) + 1 :])
    late_sec = sum(former)
    expect(
        len(later) < FEWEST or late_sec <= 1.0 / before_hz + SOON_SEC,
        expected=f'{now_hz:g} Hz at once after {name} went from {before_hz:g} to {now_hz:g}',
        seen=f'{before_hz:g} Hz for {late_sec:.1f} s more',
        hint='change the timer in the callback that is called once the value is set, and do not '
        'wait until something looks at the parameter',
        cause=f'the rate follows {name} late',
    )
