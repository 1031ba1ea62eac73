"""Whether somebody serves: that nobody but the check does, and that the check no longer does."""

from my_robot_basics.exchange.asking import wait_for_turn
from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph import services
from my_robot_basics.graph.watcher import Watcher

GONE_SEC = 1.0
"""How long a server that was just stopped may still be on the graph."""
TURNS, TURN_SEC = 4, 0.1
"""So often, each time after so long, of free time, does the notebook's process get a turn
until it knows that a server has gone."""


def expect_no_other(watcher: Watcher, name: str, *, own: int) -> None:
    """The check's `own` servers are all that the service has. Raises CheckFailed."""
    node = watcher.node
    is_alone = watcher.spin_until(lambda: node.count_services(name) <= own, timeout_sec=GONE_SEC)
    known = sorted(services.take(node).servers.get(name, {}))
    expect(
        is_alone,
        expected=f'no server of {name} but that of this check',
        # a name that begins with _ is in no list of the course's
        seen=theirs(', '.join(known)) if known else 'one more',
        hint='stop that node: here, the check itself answers',
        cause=f'another node serves {name}',
    )


def wait_until_known(watcher: Watcher) -> None:
    """Wait until the student's node has had the time to know that the check's server has gone."""
    for _ in range(TURNS):
        watcher.spin_until_free(lambda: False, free_sec=TURN_SEC)
        wait_for_turn()
