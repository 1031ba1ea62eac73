"""A server that never appears: whose fault it is, and how long a check waits for it."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks.actions import open_action
from my_robot_basics.checks.services import awaited_servers, services
from my_robot_basics.checks.services.awaited_servers import SERVER_SEC, NoServer, wait_for_server
from my_robot_basics.feedback.errors import CheckFailed, Starved
from my_robot_basics.graph.graphs import SETTLED_SEC
from rclpy.context import Context


@pytest.fixture
def waited(monkeypatch):
    """The waits in `wall` and `free` seconds; `gives` is the share of time that is free."""
    told = SimpleNamespace(wall=[], free=[], comes=False, gives=1.0, is_settled=False)

    def spin_until(is_there, *, timeout_sec):
        told.wall.append(timeout_sec)
        return told.comes

    def spin_until_free(is_there, *, free_sec):
        told.free.append(free_sec)
        return told.comes

    stopwatch = SimpleNamespace(free_sec=lambda: told.gives * sum(told.free))
    monkeypatch.setattr(awaited_servers, 'Stopwatch', lambda: stopwatch)
    monkeypatch.setattr(awaited_servers.graphs, 'is_settled', lambda watcher: told.is_settled)
    told.watcher = SimpleNamespace(
        spin_until=spin_until, spin_until_free=spin_until_free, context=Context()
    )
    return told


def test_a_server_that_appears_is_not_reported(waited):
    waited.comes = True
    assert wait_for_server(waited.watcher, '/arm', lambda: False) is None


def test_the_notebook_is_asked_once_about_a_server_that_is_still_there(monkeypatch, waited):
    asked = []
    monkeypatch.setattr(awaited_servers.graphs, 'is_settled', lambda watcher: asked.append(1))
    waited.comes = True
    for name in ('/arm', '/arm', '/other'):
        assert wait_for_server(waited.watcher, name, lambda: True) is None
    assert len(asked) == 2
    waited.comes = False
    assert wait_for_server(waited.watcher, '/arm', lambda: False).seen == 'none in 10 s'
    assert len(asked) == 3


@pytest.mark.parametrize(('gives', 'doubt'), [(1.0, CheckFailed), (0.6, Starved)])
def test_a_missing_server_counts_as_starved_on_a_busy_machine(waited, gives, doubt):
    waited.gives = gives
    none = wait_for_server(waited.watcher, '/arm', lambda: False)
    assert (none.seen, none.doubt) == ('none in 10 s', doubt)
    assert (waited.free, waited.wall) == ([SERVER_SEC], [])


def test_the_wait_is_short_if_no_server_can_appear(waited):
    waited.is_settled, waited.gives = True, 0.0
    none = wait_for_server(waited.watcher, '/arm', lambda: False)
    assert (none.seen, none.doubt) == ('none', CheckFailed)
    assert (waited.free, waited.wall) == ([], [SETTLED_SEC])


@pytest.mark.parametrize('doubt', [CheckFailed, Starved])
@pytest.mark.parametrize(
    ('module', 'graph', 'look'),
    [
        (services, services.services, lambda check: services.Service._meet(check, check.watcher)),
        (open_action, open_action.actions, open_action.OpenAction._find),
    ],
    ids=['service', 'action'],
)
def test_a_check_of_a_missing_server_raises_the_exception_of_its_wait(
    monkeypatch, module, graph, look, doubt
):
    monkeypatch.setattr(module, 'wait_for_server', lambda *_: NoServer('none in 9 s', doubt))
    seen = SimpleNamespace(why_none=lambda name, maker: f'look at {name} in {maker}(…)')
    monkeypatch.setattr(graph, 'take_graph', lambda node: seen)
    check = SimpleNamespace(name='/arm', watcher=SimpleNamespace(node=None))
    with pytest.raises(CheckFailed, match='/arm, saw none in 9 s: look at /arm in') as raised:
        look(check)
    assert raised.type is doubt
