"""That nobody but the check serves a service, whatever the other server's node is called."""

from my_robot_basics.feedback.errors import expect
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph import services
from my_robot_basics.graph.watcher import Watcher

GONE_SEC = 1.0
"""How long a server that was just stopped may still be on the graph."""


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
