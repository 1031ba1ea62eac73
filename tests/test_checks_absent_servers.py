"""Whether a client waits for an absent server, or whether only the machine is busy."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.arm import absent_servers
from my_robot_basics.checks.arm.absent_servers import publish_in_vain
from my_robot_basics.feedback.errors import Starved


class Client:
    """Answers after a given time."""

    def __init__(self, server):
        self.server = server

    def service_is_ready(self):
        return True

    def call_async(self, request):
        ready_sec = self.server.wall_sec + self.server.takes.pop(0)
        return SimpleNamespace(done=lambda: self.server.wall_sec >= ready_sec)


class Server:
    """A check's own server, which is absent for a given time."""

    name, asked_on = '/move_arm', '/goal_pose'

    def __init__(self, takes):
        self.takes = list(takes)
        self.wall_sec, self.published = 0.0, []
        publisher = SimpleNamespace(wait_for_all_acked=lambda duration: True)
        self.client = SimpleNamespace(
            answering=lambda: {'/client'}, publishers={self.asked_on: publisher}
        )
        self.watcher = self
        self.node = SimpleNamespace(
            create_client=lambda *_: Client(self), destroy_client=lambda client: None
        )

    def publish(self, message):
        self.published.append(message)

    def spin_until(self, done, *, timeout_sec):
        end_sec = self.wall_sec + timeout_sec
        while not done() and self.wall_sec < end_sec:
            self.wall_sec += 0.05
        return done()

    def spin_until_free(self, done, *, free_sec):
        return done()


@pytest.fixture
def server(monkeypatch):
    def make(*takes, free_part=1.0, line=''):
        made = Server(takes)

        class Watch:
            def __init__(self):
                self.began_sec = made.wall_sec

            def wall_sec(self):
                return made.wall_sec - self.began_sec

            def free_sec(self):
                return free_part * self.wall_sec()

        monkeypatch.setattr(absent_servers, 'Stopwatch', Watch)
        monkeypatch.setattr(absent_servers.node_troubles, 'blocking_line', lambda name: line)
        return made

    return make


WAITS = 'line 21, in send: self.client.wait_for_server()'


def test_a_client_that_answers_while_the_server_is_absent_passes(server):
    made = server(0.0, 0.1, 0.0)
    publish_in_vain(made, 'pose')
    assert (made.published, made.takes) == (['pose'], [])


@pytest.mark.parametrize(('free_part', 'line'), [(1.0, WAITS), (0.1, WAITS), (0.1, '')])
def test_a_wait_of_two_seconds_is_not_reported_on_an_idle_or_busy_machine(server, free_part, line):
    publish_in_vain(server(2.0, 0.0, 0.0, free_part=free_part, line=line), 'pose')


@pytest.mark.parametrize(
    ('free_part', 'line', 'kind'),
    [
        (1.0, WAITS, CheckFailed),
        (1.0, '', CheckFailed),
        (0.1, WAITS, CheckFailed),  # the notebook says itself that it waits
        (0.1, 'line 20, in send: goal = MoveArm.Goal()', Starved),
    ],
)
def test_a_client_that_does_not_answer_fails_unless_the_machine_is_too_busy(
    server, free_part, line, kind
):
    made = server(0.0, 5.0, free_part=free_part, line=line)
    with pytest.raises(CheckFailed, match=r'look at server_is_ready\(\)') as failure:
        publish_in_vain(made, 'pose')
    assert type(failure.value) is kind
