"""How busy the machine is, as Linux reports it: a delay on a busy machine proves nothing."""

import itertools
import re
import time
from collections.abc import Iterator
from pathlib import Path

CPU, UPTIME = Path('/proc/pressure/cpu'), Path('/proc/uptime')
COARSE_SEC = 0.02
"""Linux counts idle time in hundredths of a second."""
BUSY_TIMES = 5.0
"""How many times as long an answer may take if processes have to wait for a processor."""


def stalled_sec() -> float:
    """Return for how many seconds so far some process had to wait for a processor.

    Only differences are meaningful. 0.0 if Linux does not report it (psi=0).
    """
    try:
        text = CPU.read_text(encoding='ascii')
    except OSError:
        return 0.0
    total_us = re.search(r'^some .*total=(\d+)', text)
    return int(total_us[1]) / 1e6 if total_us else 0.0


def idle_sec() -> float:
    """Return for how many seconds so far the processors were idle, summed over all of them.

    Only differences are meaningful.
    """
    try:
        return float(UPTIME.read_text(encoding='ascii').split()[1])
    except (OSError, IndexError, ValueError):  # not reported: as if one were always idle
        return time.monotonic()


class Stopwatch:
    """Measures time since its creation."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._stalled_sec, self._idle_sec = stalled_sec(), idle_sec()

    def wall_sec(self) -> float:
        """Return the seconds since then on the monotonic clock."""
        return time.monotonic() - self._start

    def free_sec(self) -> float:
        """Return the seconds since then in which no process had to wait for a processor.

        The result is at most the time that processors were idle: a virtual machine with shared
        processors reports only a part of the waiting.
        """
        told_sec = self.wall_sec() - (stalled_sec() - self._stalled_sec)
        return max(0.0, min(told_sec, idle_sec() - self._idle_sec + COARSE_SEC))

    def is_busy(self) -> bool:
        """Whether some process had to wait for a processor for most of the measured time."""
        return self.free_sec() < 0.5 * self.wall_sec()


def free_turns(free_sec: float, wall_sec: float | None = None) -> Iterator[int]:
    """Yield 1, 2, … until `free_sec` have passed in which no process waited for a processor.

    On a busy machine, it ends after `wall_sec`, by default BUSY_TIMES as much.
    """
    most_sec = BUSY_TIMES * free_sec if wall_sec is None else wall_sec
    watch = Stopwatch()
    for turn in itertools.count(1):
        yield turn
        if watch.free_sec() >= free_sec or watch.wall_sec() >= most_sec:
            return
