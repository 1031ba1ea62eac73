"""How long the grader waits for code that gets too little of a processor, and code that sleeps."""

import asyncio
from types import SimpleNamespace

import pytest
from my_robot_basics.validate.kernels import timeouts
from my_robot_basics.validate.kernels.timeouts import (
    LOOK_EVERY_SEC,
    MOST_TIMES,
    wait_for_end_by_cpu_time,
)

LIMIT_SEC = 10.0


@pytest.fixture
def waits(monkeypatch):
    """Return whether code that needs so much processor time ended, and how long the wait was.

    The code gets a share of a processor, and the machine is idle for another share of the time.
    Code that ran before in the same kernel has used some, too.
    """

    def wait(needs_sec, *, gets, is_free=0.0, counted=lambda wall_sec: True, floods=False):
        waited = SimpleNamespace(wall_sec=0.0)

        def used_sec():
            return 100.0 + gets * waited.wall_sec if counted(waited.wall_sec) else None

        async def wait_for_end(done, seconds, is_alive, is_enough):
            if is_enough():
                return False
            waited.wall_sec += seconds
            return gets * waited.wall_sec >= needs_sec

        watch = SimpleNamespace(
            wall_sec=lambda: waited.wall_sec, free_sec=lambda: is_free * waited.wall_sec
        )
        monkeypatch.setattr(timeouts, 'wait_for_end', wait_for_end)
        monkeypatch.setattr(timeouts.pressure, 'Stopwatch', lambda: watch)
        ended = asyncio.run(
            wait_for_end_by_cpu_time(None, LIMIT_SEC, None, lambda: floods, used_sec)
        )
        return ended, pytest.approx(waited.wall_sec, abs=2 * LOOK_EVERY_SEC)

    return wait


def test_code_that_gets_a_fifth_of_a_processor_is_waited_for(waits):
    assert waits(4.0, gets=0.2) == (True, 20.0)


def test_processor_time_used_or_left_free_counts_towards_the_limit(waits):
    assert waits(100.0, gets=1.0) == (False, LIMIT_SEC)
    assert waits(100.0, gets=0.5) == (False, 20.0)
    assert waits(100.0, gets=0.2, is_free=0.8) == (False, 12.5)


def test_the_wait_for_starved_code_ends_after_a_multiple_of_the_limit(waits):
    assert waits(4.0, gets=0.1) == (False, MOST_TIMES * LIMIT_SEC)


@pytest.mark.parametrize('gets', [0.0, 0.009])
def test_code_that_sleeps_is_given_up_at_the_limit(waits, gets):
    assert waits(4.0, gets=gets) == (False, LIMIT_SEC)


@pytest.mark.parametrize(
    'counted',
    [lambda wall_sec: False, lambda wall_sec: wall_sec > 0.0, lambda wall_sec: wall_sec == 0.0],
    ids=['never', 'only later', 'no longer'],
)
def test_the_wait_ends_at_the_limit_if_processor_time_is_not_measured(waits, counted):
    assert waits(4.0, gets=0.2, counted=counted) == (False, LIMIT_SEC)


def test_code_that_floods_its_output_is_given_up_at_once(waits):
    assert waits(4.0, gets=0.2, floods=True) == (False, 0.0)
