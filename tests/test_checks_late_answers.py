"""How long a check waits for a client's message, on an idle machine and on a busy one."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks.services import late_answers
from my_robot_basics.session import pressure

WAITS, WORKS = 'line 9, in ask: done.wait(timeout=5.0)', 'line 9, in ask: self.solve(target)'


@pytest.fixture
def in_time(monkeypatch):
    """A function: whether a message that comes after so many seconds is in time."""

    def look(after_sec, *, free_part, line):
        now = [0.0]

        def spin_until(done, timeout_sec):
            now[0] = min(after_sec, now[0] + timeout_sec) if now[0] < after_sec else now[0] + 0.01
            return done()

        clock = SimpleNamespace(monotonic=lambda: now[0])
        monkeypatch.setattr(pressure, 'time', clock)
        monkeypatch.setattr(late_answers, 'time', clock)
        monkeypatch.setattr(pressure, 'stalled_sec', lambda: (1.0 - free_part) * now[0])
        monkeypatch.setattr(pressure, 'idle_sec', lambda: now[0])
        monkeypatch.setattr(late_answers.node_troubles, 'blocking_line', lambda name: line)
        return late_answers.comes_in_time(
            SimpleNamespace(spin_until=spin_until),
            lambda: now[0] >= after_sec,
            free_sec=4.0,
            names=['/ik_client'],
        )

    return look


@pytest.mark.parametrize('free_part', [1.0, 0.5, 0.1])
@pytest.mark.parametrize(('after_sec', 'is_in_time'), [(2.0, True), (5.0, False)])
def test_a_wait_in_a_callback_has_the_same_limit_however_busy_the_machine_is(
    in_time, after_sec, is_in_time, free_part
):
    assert in_time(after_sec, free_part=free_part, line=WAITS) == is_in_time


@pytest.mark.parametrize(
    ('free_part', 'line', 'is_in_time'),
    [(1.0, WORKS, False), (0.5, WORKS, True), (0.5, '', True), (0.1, '', True)],
)
def test_a_client_that_works_gets_the_time_in_which_it_had_no_processor(
    in_time, free_part, line, is_in_time
):
    assert in_time(5.0, free_part=free_part, line=line) == is_in_time


@pytest.mark.parametrize('free_part', [1.0, 0.1])
def test_a_message_that_never_comes_is_not_waited_for_without_end(in_time, free_part):
    assert not in_time(1000.0, free_part=free_part, line='')
