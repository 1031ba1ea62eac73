"""End a program that a check has started, as Ctrl-C does, without a verdict.

A node that was killed stays on the graph for a while, and the next check would meet it.
"""

import time
from collections.abc import Callable

from my_robot_basics.session.pressure import Stopwatch

LEAVE_SEC, MOST_SEC = 2.0, 6.0
"""How long it may take, of free time, and at most."""
LOOK_EVERY_SEC = 0.05


def end(send: Callable[[str], object], has_ended: Callable[[], bool]) -> None:
    """Send it SIGINT, and SIGKILL where it goes on; `send` takes a signal's name."""
    send('SIGINT')
    watch = Stopwatch()
    while not has_ended():
        if watch.free_sec() > LEAVE_SEC or watch.wall_sec() > MOST_SEC:
            send('SIGKILL')
            return
        time.sleep(LOOK_EVERY_SEC)
