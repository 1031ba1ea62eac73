"""How busy the machine is, as Linux tells it: time without a free processor proves nothing."""

import itertools
import re
import time
from collections.abc import Iterator
from pathlib import Path

CPU, UPTIME = Path('/proc/pressure/cpu'), Path('/proc/uptime')
COARSE_SEC = 0.02
"""Linux counts idle time in hundredths of a second."""
BUSY_TIMES = 5.0
"""How many times as long an answer may take where processes have to wait for a processor."""


def stalled_sec() -> float:
    """For how long so far some process had to wait for a processor, in seconds.

    Only differences mean anything. 0.0 where Linux does not tell (psi=0).
    """
    try:
        text = CPU.read_text(encoding='ascii')
    except OSError:
        return 0.0
    total_us = re.search(r'^some .*total=(\d+)', text)
    return int(total_us[1]) / 1e6 if total_us else 0.0


def idle_sec() -> float:
    """For how long so far the processors were idle, all of them together, in seconds.

    Only differences mean anything.
    """
    try:
        return float(UPTIME.read_text(encoding='ascii').split()[1])
    except (OSError, IndexError, ValueError):  # where Linux does not tell: as if one had been
        return time.monotonic()


class Stopwatch:
    """Measures time from when it is made."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._stalled_sec, self._idle_sec = stalled_sec(), idle_sec()

    def wall_sec(self) -> float:
        """Seconds of steady wall time."""
        return time.monotonic() - self._start

    def free_sec(self) -> float:
        """Seconds of it in which no process had to wait for a processor.

        Nor is more of it free than processors were idle: a virtual machine that shares them tells
        of a part of the waiting alone.
        """
        told_sec = self.wall_sec() - (stalled_sec() - self._stalled_sec)
        return max(0.0, min(told_sec, idle_sec() - self._idle_sec + COARSE_SEC))

    def is_busy(self) -> bool:
        """Whether some process had to wait for a processor for most of it."""
        return self.free_sec() < 0.5 * self.wall_sec()


def free_turns(free_sec: float) -> Iterator[int]:
    """Yield 1, 2, … until so much time has passed in which no process waited for a processor."""
    watch = Stopwatch()
    for turn in itertools.count(1):
        yield turn
        if watch.free_sec() >= free_sec or watch.wall_sec() >= BUSY_TIMES * free_sec:
            return
