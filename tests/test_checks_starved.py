"""When a busy machine is to blame for a rate, and not the node."""

from dataclasses import replace

import pytest
from made_recordings import on_wall
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.recordings import recording as recording_module
from my_robot_basics.feedback.errors import Starved

LOOKS_EVERY_10_MS = [0.21, 0.21, 0.2, 0.21, 0.21, 0.22, 0.21] * 3
KEPT_WAITING = [0.2, 0.21, 0.9, 0.2, 0.33, 0.2, 0.2, 0.8, 1.1, 0.2, 0.27, 0.5]


@pytest.fixture
def told(monkeypatch):
    """A function that returns the type of the failure for 5 Hz, if no callback has raised."""
    monkeypatch.setattr(recording_module.callbacks, 'expect_none_so_far', lambda names: None)

    def type_of_failure(recording):
        with pytest.raises(CheckFailed) as failed:
            recording.assert_rate(hz=5.0)
        return failed.type

    return type_of_failure


@pytest.mark.parametrize(
    ('gaps_sec', 'is_makeshift', 'doubt'),
    [
        (LOOKS_EVERY_10_MS, True, Starved),
        (LOOKS_EVERY_10_MS, False, CheckFailed),
        (KEPT_WAITING, True, Starved),
        (KEPT_WAITING, False, CheckFailed),
        ([1.0, 1.01, 1.0, 1.01], True, CheckFailed),
        ([0.1, 0.11] * 15, True, CheckFailed),
    ],
    ids=['nearly right', 'the clock was driven', 'pauses', 'pauses of its own', '1 Hz', '10 Hz'],
)
def test_a_nearly_right_rate_in_a_makeshift_recording_counts_as_starved(
    told, gaps_sec, is_makeshift, doubt
):
    recording = replace(on_wall(gaps_sec, late_sec=0.0), is_makeshift=is_makeshift)
    assert told(recording) is doubt


STARVED_GAPS = [0.2, 0.33, 0.21, 0.41, 0.2, 0.28, 0.2, 0.37, 0.22, 0.2, 0.3, 0.25, 0.44, 0.2]
"""Of a right node on a machine that had no time for it: 3.7 Hz."""


@pytest.mark.parametrize(
    ('gaps_sec', 'late_sec', 'doubt'),
    [
        (STARVED_GAPS, 0.15, Starved),
        (STARVED_GAPS, 0.0, CheckFailed),
        ([0.25] * 16, 0.3, CheckFailed),
        ([1.0, 1.02, 0.99, 1.01], 0.3, CheckFailed),
        ([0.1, 0.12, 0.08, 0.13, 0.1, 0.07] * 5, 0.3, CheckFailed),
        ([0.1, 0.3, 0.11, 0.29] * 10, 0.3, CheckFailed),
        ([0.2, 0.21, 0.2, 0.19, 1.4, 0.2, 0.2, 0.23, 0.2, 0.2], 0.1, CheckFailed),
    ],
    ids=['starved', 'idle', '4_hz', '1_hz', '10_hz', 'by_turns', 'a_pause'],
)
def test_a_late_recording_excuses_only_rates_that_a_busy_machine_can_cause(
    told, gaps_sec, late_sec, doubt
):
    assert told(on_wall(gaps_sec, late_sec=late_sec)) is doubt


@pytest.mark.parametrize(
    ('gaps_sec', 'was_busy', 'doubt'),
    [
        (STARVED_GAPS[:6], True, CheckFailed),
        ([*STARVED_GAPS, *[0.2] * 12], True, Starved),
        ([*STARVED_GAPS, *[0.2] * 12], False, CheckFailed),
        ([0.22] * 16, True, CheckFailed),
        ([0.206, 0.2065] * 10, True, Starved),
        ([0.206, 0.2065] * 10, False, CheckFailed),
        ([0.194, 0.1945] * 10, True, CheckFailed),
        ([*[0.2] * 9, 0.4, *[0.2] * 9], True, Starved),
        ([*[0.2] * 9, 0.4, *[0.2] * 9], False, CheckFailed),
        ([*[0.21] * 9, 0.42, *[0.21] * 9], True, CheckFailed),
        ([0.03, *[0.2] * 19], True, Starved),
        ([0.03, *[0.2] * 19], False, CheckFailed),
        ([0.03, *[0.19] * 19], True, CheckFailed),
    ],
    ids=[
        *('0.7 of the rate', 'nearly right', 'idle', '4.5 Hz'),
        *('late each time', 'late each time, idle', 'early each time'),
        *('one pause', 'one pause, idle', 'one pause of another rate'),
        *('the first is late', 'the first is late, idle', 'the first of another rate is late'),
    ],
)
def test_a_busy_machine_excuses_small_errors_of_a_recording_in_time(
    told, gaps_sec, was_busy, doubt
):
    recording = replace(on_wall(gaps_sec, late_sec=0.0), was_busy=was_busy)
    assert told(recording) is doubt
