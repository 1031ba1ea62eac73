"""How busy the machine is, as Linux tells it: time without a free processor proves nothing."""

import re
import time
from pathlib import Path

CPU = Path('/proc/pressure/cpu')


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


class Stopwatch:
    """Measures time from when it is made."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._stalled_sec = stalled_sec()

    def wall_sec(self) -> float:
        """Seconds of steady wall time."""
        return time.monotonic() - self._start

    def free_sec(self) -> float:
        """Seconds of it in which no process had to wait for a processor."""
        return max(0.0, self.wall_sec() - (stalled_sec() - self._stalled_sec))

    def is_busy(self) -> bool:
        """Whether some process had to wait for a processor for most of it."""
        return self.free_sec() < 0.5 * self.wall_sec()
