"""Whether a node takes on a new rate soon after its parameter was set."""

from dataclasses import replace

import numpy as np
import pytest
from made_recordings import every, recording
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.late_rates import expect_soon


def changing(late_sec, *, before_hz, now_hz, seconds=4.0, step_sec=0.01):
    """A recording at `now_hz`, after one in which the rate changes to it after `late_sec`."""
    first = np.arange(1, round(late_sec * before_hz) + 1) / before_hz
    begin = first[-1] if len(first) else 0.0
    then = begin + np.arange(1, round((seconds - begin) * now_hz) + 1) / now_hz
    times = [step_sec * np.ceil(each / step_sec - 0.01) for each in [*first, *then]]
    uneven = recording(times, seconds=seconds, step_sec=step_sec)
    right = recording(every(1.0 / now_hz, 20), seconds=4.0)
    return replace(right, uneven=uneven)


@pytest.mark.parametrize(
    ('late_sec', 'before_hz', 'now_hz', 'is_soon'),
    [
        (0.0, 5.0, 12.5, True),
        (0.6, 5.0, 12.5, True),
        (1.0, 5.0, 12.5, False),
        (2.0, 12.5, 50.0, False),
        (0.4, 50.0, 25.0, True),
        (1.0, 50.0, 25.0, False),
        (2.0, 25.0, 8.0, False),
        (1.0, 1.0, 12.5, True),
        (2.0, 1.0, 12.5, False),
    ],
)
def test_a_rate_may_change_within_half_a_second_and_one_former_period(
    late_sec, before_hz, now_hz, is_soon
):
    seen = changing(late_sec, before_hz=before_hz, now_hz=now_hz)
    if is_soon:
        expect_soon(seen, 'rate_hz', before_hz, now_hz)
        return
    with pytest.raises(
        CheckFailed,
        match=f'expected {now_hz:g} Hz at once .*, saw {before_hz:g} Hz for {late_sec}',
    ):
        expect_soon(seen, 'rate_hz', before_hz, now_hz)


def test_gaps_that_never_become_those_of_the_new_rate_are_no_late_change():
    """A thread that got no processor for a while is late, and does not change its rate."""
    times = [0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 2.0, 2.2, 2.9, 3.1]
    seen = replace(recording(every(0.08, 20), seconds=4.0), uneven=recording(times, seconds=4.0))
    expect_soon(seen, 'rate_hz', 5.0, 12.5)


def test_an_even_recording_shows_no_late_change():
    expect_soon(recording(every(0.08, 20), seconds=4.0), 'rate_hz', 5.0, 12.5)
