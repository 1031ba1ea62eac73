"""A server that does not come: whose fault it is, and how long anybody waits for it."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import awaited_servers
from my_robot_basics.checks.awaited_servers import SERVER_SEC, wait_for_server
from my_robot_basics.feedback.errors import CheckFailed, Starved
from my_robot_basics.graph.graphs import SETTLED_SEC


@pytest.fixture
def waited(monkeypatch):
    """What is waited for; `wall` and `free` seconds, and what the machine gives of them."""
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
    told.watcher = SimpleNamespace(spin_until=spin_until, spin_until_free=spin_until_free)
    return told


def test_one_that_comes_is_nothing_to_talk_about(waited):
    waited.comes = True
    assert wait_for_server(waited.watcher, lambda: False) is None


@pytest.mark.parametrize(('gives', 'doubt'), [(1.0, CheckFailed), (0.6, Starved)])
def test_a_program_without_a_processor_is_not_to_blame(waited, gives, doubt):
    waited.gives = gives
    none = wait_for_server(waited.watcher, lambda: False)
    assert (none.seen, none.doubt) == ('none in 10 s', doubt)
    assert (waited.free, waited.wall) == ([SERVER_SEC], [])


def test_where_none_can_come_nobody_waits_for_long(waited):
    waited.is_settled, waited.gives = True, 0.0
    none = wait_for_server(waited.watcher, lambda: False)
    assert (none.seen, none.doubt) == ('none', CheckFailed)
    assert (waited.free, waited.wall) == ([], [SETTLED_SEC])
