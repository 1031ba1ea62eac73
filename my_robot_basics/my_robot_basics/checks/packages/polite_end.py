"""End a program that a check has started, as Ctrl-C does; this affects no verdict.

SIGINT comes first, because a killed node stays on the graph and would disturb the next check.
"""

import time
from collections.abc import Callable

from my_robot_basics.session.pressure import Stopwatch

LEAVE_SEC, MOST_SEC = 2.0, 6.0
"""How long the program may take to end: in seconds of free time, and of wall time at most."""
LOOK_EVERY_SEC = 0.05


def end(send: Callable[[str], object], has_ended: Callable[[], bool]) -> None:
    """Send SIGINT to the program, and SIGKILL if it does not end; `send` takes a signal's name."""
    send('SIGINT')
    watch = Stopwatch()
    while not has_ended():
        if watch.free_sec() > LEAVE_SEC or watch.wall_sec() > MOST_SEC:
            send('SIGKILL')
            return
        time.sleep(LOOK_EVERY_SEC)
