"""SIGINT, SIGTERM and SIGHUP: the end of a command at any moment, with the exit status of ros2cli.

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
    """Take the signals over, also where a shell had them ignored (`ros2 … &` in a script).

    SIGHUP, of a terminal that closes, stays ignored: that is what `nohup` is for.
    """
    signal.signal(signal.SIGINT, _stop)
    signal.signal(signal.SIGTERM, _stop)
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, _stop)
    signal.signal(signal.SIGALRM, _give_up)


def leave_in_good_order() -> None:
    """From now on a signal is only noted, for `check` to raise."""
    global _cleans_up
    _cleans_up = True


def check() -> None:
    """Raise Stopped if a signal was noted."""
    if _noted:
        raise Stopped(_noted)


def may_go_on(stopped: Stopped) -> bool:
    """Whether the command may answer a signal by something else than its end; then it goes on.

    That is so for Ctrl-C, and where a terminal closes. The next signal is noted again.
    """
    global _noted
    if stopped.number not in (signal.SIGINT, signal.SIGHUP):
        return False
    _noted = 0
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    return True


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
