"""How long a check waits for responses that a slow server sends one after the other."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks.services.services import wait_for_all


@pytest.fixture
def are_answered():
    """A function: whether all requests are answered in time by a server that takes `each_sec`."""

    def look(requests, *, each_sec, free_part):
        now = [0.0]

        def spin_until_free(done, free_sec):
            end = now[0] + free_sec / free_part
            while not done() and now[0] < end:
                now[0] += 0.01
            return done()

        def future(number):
            return SimpleNamespace(done=lambda: now[0] >= number * each_sec)

        asked = [future(number) for number in range(1, requests + 1)]
        watcher = SimpleNamespace(spin_until_free=spin_until_free)
        return wait_for_all(watcher, asked, gives_up=str, names=[])

    return look


@pytest.mark.parametrize('free_part', [1.0, 0.5, 0.2])
@pytest.mark.parametrize('each_sec', [0.1, 0.5, 1.0, 2.0])
def test_ten_slow_answers_are_in_time_however_busy_the_machine_is(
    are_answered, each_sec, free_part
):
    assert are_answered(10, each_sec=each_sec, free_part=free_part)


@pytest.mark.parametrize('requests', [1, 10])
def test_an_answer_that_comes_later_than_four_seconds_is_late(are_answered, requests):
    assert not are_answered(requests, each_sec=5.0, free_part=1.0)
