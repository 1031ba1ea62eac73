"""How long a check waits for a server to appear, and what it makes of one that does not."""

from collections.abc import Callable
from dataclasses import dataclass

from my_robot_basics.checks.doubts import doubt_after
from my_robot_basics.feedback.errors import CheckFailed
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

SERVER_SEC = 10.0
"""How long to wait, of time that was free: a program that was started just now may have had no
processor."""


@dataclass(frozen=True)
class NoServer:
    """No server has come."""

    seen: str
    """How long nothing was seen, in words."""
    doubt: type[CheckFailed]
    """What to raise: the machine may be to blame."""


def wait_for_server(watcher: Watcher, is_there: Callable[[], bool]) -> NoServer | None:
    """Wait for a server, and not for long where the notebook says that none can come.

    None where it is there.
    """
    if graphs.is_settled(watcher):
        timeout_sec, doubt = graphs.SETTLED_SEC, CheckFailed
        came = watcher.spin_until(is_there, timeout_sec=timeout_sec)
    else:
        timeout_sec, watch = SERVER_SEC, Stopwatch()
        came = watcher.spin_until_free(is_there, free_sec=timeout_sec)
        doubt = doubt_after(watch, timeout_sec)
    return None if came else NoServer(graphs.none_in(timeout_sec), doubt)
