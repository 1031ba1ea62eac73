"""Ensure that only the check serves, and that the student's node notices when it stops."""

from collections.abc import Iterable

from my_robot_basics.exchange.asking import wait_for_turn
from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import services
from my_robot_basics.graph.watcher import Watcher

GONE_SEC = 1.0
"""How long a server that was just stopped may remain on the graph."""
TURNS, TURN_SEC = 4, 0.1
"""To let the notebook's process notice that a server has gone: TURNS times, wait TURN_SEC of free
time, then until that process has answered something."""


def stop_call(node_names: Iterable[str]) -> str:
    """The calls that stop these nodes in a cell, and leave the student's client running."""
    calls = [f'stop({name!r})' for name in sorted(node_names)]
    return student_text(', '.join(calls)) if calls else 'stop(…)'


def expect_no_other(watcher: Watcher, name: str, *, own: int, stop: str = '') -> None:
    """The service has only the servers of the check, `own` in number. Raises CheckFailed.

    `stop` is the call that ends another one; by default it names that node.
    """
    node = watcher.node
    is_alone = watcher.spin_until(lambda: node.count_services(name) <= own, timeout_sec=GONE_SEC)
    known = sorted(services.take_graph(node).servers.get(name, {}))
    expect(
        is_alone,
        expected=f'no server of {name} but that of this check',
        # `services.take_graph` leaves out nodes whose names begin with _
        seen=student_text(', '.join(known)) if known else 'one more',
        hint=f'stop that node, with {stop or stop_call(known)} in a cell or Ctrl-C in its'
        ' terminal: here, the check itself answers',
        cause=f'another node serves {name}',
    )


def wait_until_known(watcher: Watcher) -> None:
    """Wait until the student's node has had time to notice that the check's server has gone."""
    for _ in range(TURNS):
        watcher.spin_until_free(lambda: False, free_sec=TURN_SEC)
        wait_for_turn()
