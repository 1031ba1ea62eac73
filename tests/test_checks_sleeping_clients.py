"""Whether a client of actions that sleeps in a callback is found, however late the callback is."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.actions import client_nodes
from my_robot_basics.checks.actions.client_nodes import ClientNodes
from my_robot_basics.checks.actions.served_action import REPLY_SEC
from my_robot_basics.checks.services import late_answers
from my_robot_basics.live.output.troubles import UNFINISHED_SEC
from my_robot_basics.session import pressure

LINE = 'line 21, in send: time.sleep(1.0)'


class Sleeper:
    """A client whose callback begins after `late_sec`, sleeps, and then does what it should.

    Of the time, `free_part` is free: a check that waits for free time waits longer than that.
    """

    def __init__(self, late_sec, sleeps_sec, free_part=1.0):
        self.now_sec, self.began_sec, self.free_part = 0.0, late_sec, free_part
        self.over_sec = late_sec + sleeps_sec
        client = SimpleNamespace(
            service_is_ready=lambda: True, call_async=lambda _: SimpleNamespace(done=self.is_done)
        )
        self.node = SimpleNamespace(
            create_client=lambda *_: client, destroy_client=lambda client: None
        )

    def is_done(self):
        return self.now_sec >= self.over_sec

    def spin_until(self, done, *, timeout_sec):
        end_sec = self.now_sec + timeout_sec
        while not done() and self.now_sec < end_sec:
            self.now_sec += 0.005
        return done()

    def spin_until_free(self, done, *, free_sec):
        return self.spin_until(done, timeout_sec=free_sec / self.free_part)

    def blocking_line(self, _):
        """As the notebook answers: a callback that is in progress at both of two looks."""
        looked_sec, self.now_sec = self.now_sec, self.now_sec + 0.005 + UNFINISHED_SEC
        return LINE if self.began_sec <= looked_sec and self.now_sec < self.over_sec else ''


def wait_for_goal(sleeper, client):
    assert client.comes_in_time(sleeper.is_done, REPLY_SEC, may_sleep=False)


def wait_for_answer(sleeper, client):
    client.answering(may_sleep=False)


@pytest.fixture(params=[wait_for_goal, wait_for_answer])
def wait(request, monkeypatch):
    """A function: wait for what the client does after its sleep."""

    def wait(late_sec, sleeps_sec):
        sleeper = Sleeper(late_sec, sleeps_sec)
        outcomes = SimpleNamespace(publishers=lambda: ('/move_arm_client',))
        monkeypatch.setattr(client_nodes.node_troubles, 'blocking_line', sleeper.blocking_line)
        request.param(sleeper, ClientNodes(sleeper, outcomes))

    return wait


LATE_SEC = 0.0, 0.01, 0.05, 0.2
"""How long a message takes to the callback, on an idle machine and on busy ones."""


@pytest.mark.parametrize('late_sec', LATE_SEC)
@pytest.mark.parametrize('sleeps_sec', [1.0, 2.0])
def test_a_client_that_sleeps_for_a_second_or_two_is_found(wait, sleeps_sec, late_sec):
    with pytest.raises(CheckFailed, match='it sleeps inside a callback'):
        wait(late_sec, sleeps_sec)


@pytest.mark.parametrize('late_sec', LATE_SEC)
@pytest.mark.parametrize('sleeps_sec', [0.1, 0.5])
def test_a_client_that_sleeps_for_half_a_second_is_not(wait, sleeps_sec, late_sec):
    wait(late_sec, sleeps_sec)


@pytest.mark.parametrize('free_part', [1.0, 0.5, 0.2])
@pytest.mark.parametrize(('sleeps_sec', 'is_in_time'), [(2.0, True), (5.0, False)])
def test_a_sleep_that_is_allowed_has_the_same_limit_however_busy_the_machine_is(
    monkeypatch, sleeps_sec, is_in_time, free_part
):
    sleeper = Sleeper(0.0, sleeps_sec, free_part)
    clock = SimpleNamespace(monotonic=lambda: sleeper.now_sec)
    monkeypatch.setattr(pressure, 'time', clock)
    monkeypatch.setattr(late_answers, 'time', clock)
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: (1.0 - free_part) * sleeper.now_sec)
    monkeypatch.setattr(pressure, 'idle_sec', lambda: sleeper.now_sec)
    monkeypatch.setattr(client_nodes.node_troubles, 'blocking_line', sleeper.blocking_line)
    outcomes = SimpleNamespace(publishers=lambda: ('/move_arm_client',))
    client = ClientNodes(sleeper, outcomes)
    assert client.comes_in_time(sleeper.is_done, REPLY_SEC, may_sleep=True) == is_in_time
