"""In which tick of the robot's clock a timer's next message is due."""

from collections import deque

ALIKE = 3
"""So many messages running, each as many ticks after the one before, tell when one is due …"""
QUICK_PART = 0.5
"""… where the tick of each took less than this part of a period: nothing was left to be done."""


class DueTicks:
    """Learns from the ticks of a clock; one with a message that was due may go unasked.

    A message tells that its tick has fired the timer. Between two of them are ticks in which none
    is due: whatever else the timers bring comes to light in these.
    """

    def __init__(self) -> None:
        self._step_ns = 0
        self._gaps: deque[int] = deque(maxlen=ALIKE)
        self._since = 0
        """Ticks since the last message."""

    def is_next(self, step_ns: int) -> bool:
        """Whether a tick of that step would bring a message."""
        is_known = step_ns == self._step_ns and len(self._gaps) == ALIKE
        return is_known and {*self._gaps} == {self._since + 1} != {1}

    def note(self, step_ns: int, *, messages: int, took_sec: float) -> None:
        """Learn from a tick, how many messages came in it, and how long it took."""
        if step_ns != self._step_ns:
            self._step_ns = step_ns
            self._gaps.clear()
        self._since += 1
        if not messages:
            return
        if messages == 1 and took_sec * 1e9 < QUICK_PART * self._since * step_ns:
            self._gaps.append(self._since)
        else:
            self._gaps.clear()
        self._since = 0
