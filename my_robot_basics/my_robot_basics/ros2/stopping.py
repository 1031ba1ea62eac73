"""SIGINT, SIGTERM and SIGHUP: end a command at any moment, with the exit status of ros2cli.

Before a participant exists there is nothing to clean up, and the process ends at once. Afterwards
the signal is recorded, waiting code checks for it often, and the participant is destroyed
properly: one that is killed stays on the graph for seconds.
"""

import os
import signal
from types import FrameType

from my_robot_basics.ros2.errors import Stopped

GRACE_SEC = 1.0
"""How long the process may take to end after a signal; a write to a full pipe can block it."""

_cleans_up = False
_noted = 0


def set_handlers() -> None:
    """Set the signal handlers, also if a shell ignores the signals (`ros2 … &` in a script).

    An ignored SIGHUP, which a closing terminal sends, stays ignored: `nohup` relies on this.
    """
    signal.signal(signal.SIGINT, _stop)
    signal.signal(signal.SIGTERM, _stop)
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, _stop)
    signal.signal(signal.SIGALRM, _give_up)


def only_record_signals() -> None:
    """From now on, only record a signal, which `check` then raises."""
    global _cleans_up
    _cleans_up = True


def check() -> None:
    """Raise Stopped if a signal was recorded."""
    if _noted:
        raise Stopped(_noted)


def resume_after(stopped: Stopped) -> bool:
    """Whether the command may continue after this signal; if so, clear the record of it.

    It may after Ctrl-C, and after the terminal was closed. The next signal is recorded again.
    """
    global _noted
    if stopped.number not in (signal.SIGINT, signal.SIGHUP):
        return False
    _noted = 0
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    return True


def cancel_alarm() -> None:
    """Cancel the alarm after the cleanup: the end of Python itself may take longer."""
    signal.setitimer(signal.ITIMER_REAL, 0.0)


def _stop(number: int, frame: FrameType | None) -> None:
    global _noted
    if not _cleans_up:
        os._exit(number)
    _noted = _noted or number
    signal.setitimer(signal.ITIMER_REAL, GRACE_SEC)


def _give_up(number: int, frame: FrameType | None) -> None:
    os._exit(_noted)
