"""SIGINT and SIGTERM: the end of a command at any moment, with the exit status of ros2cli.

Before a participant exists there is nothing to clean up, and the process ends on the spot.
Afterwards the signal is noted, waiting code checks for it often, and the participant leaves the
graph in good order: one that is killed stays there as a ghost for seconds.
"""

import os
import signal
from types import FrameType

from my_robot_basics.ros2.errors import Stopped

GRACE_SEC = 1.0
"""So long a noted signal may take to end the process; a write to a full pipe can hold it up."""

_cleans_up = False
_noted = 0


def watch() -> None:
    """Take the signals over, also where a shell had them ignored (`ros2 … &` in a script)."""
    signal.signal(signal.SIGINT, _stop)
    signal.signal(signal.SIGTERM, _stop)
    signal.signal(signal.SIGALRM, _give_up)


def leave_in_good_order() -> None:
    """From now on a signal is only noted, for `check` to raise."""
    global _cleans_up
    _cleans_up = True


def check() -> None:
    """Raise Stopped if a signal was noted."""
    if _noted:
        raise Stopped(_noted)


def finish() -> None:
    """All is cleaned up: the end of Python itself, without our handlers, may take its time."""
    signal.setitimer(signal.ITIMER_REAL, 0.0)


def _stop(number: int, frame: FrameType | None) -> None:
    global _noted
    if not _cleans_up:
        os._exit(number)
    _noted = _noted or number
    signal.setitimer(signal.ITIMER_REAL, GRACE_SEC)


def _give_up(number: int, frame: FrameType | None) -> None:
    os._exit(_noted)
