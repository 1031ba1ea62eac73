"""Wait for what a client makes of a response, and not for a callback that waits too long."""

import time
from collections.abc import Callable, Collection

from my_robot_basics.exchange import node_troubles
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import free_turns

ASKED_SEC, LOOK_SEC = 0.5, 0.1
"""After ASKED_SEC of wall time, the notebook is asked whether a callback waits by itself; then the
check looks for the answer every LOOK_SEC."""
WAITED_SEC = 4.5
"""If so, the answer is late after so many seconds of wall time, however busy the machine is: by
free time alone, a wait of 5 s would be in time on a busy machine only."""


def comes_in_time(
    watcher: Watcher, done: Callable[[], bool], *, free_sec: float, names: Collection[str]
) -> bool:
    """Spin until `done()`, at most `free_sec` of free time; return whether it is done.

    `names`: the full names of the client's nodes.
    """
    began = time.monotonic()
    if watcher.spin_until(done, timeout_sec=ASKED_SEC):
        return True
    waits = any(map(node_troubles.waits_in_callback, names))
    for _ in free_turns(free_sec - ASKED_SEC):
        if watcher.spin_until(done, timeout_sec=LOOK_SEC):
            return True
        if waits and time.monotonic() - began >= WAITED_SEC:
            return False
    return False
