"""In which tick of the robot's clock a timer's next message is due."""

from collections import deque

ALIKE = 3
"""After so many messages in a row at equal distances in ticks, the next tick with one is known."""
QUICK_PART = 0.5
"""A message counts if its tick took less than this part of a period: its callback is short."""


class DueTicks:
    """Learns from the ticks of a clock in which of them a message is due.

    In such a tick, the node is not asked: the message shows that the timer has fired. It is asked
    in the ticks between two messages, which show whatever else the timers do.
    """

    def __init__(self) -> None:
        self._step_ns = 0
        self._gaps: deque[int] = deque(maxlen=ALIKE)
        self._since = 0
        """How many ticks there were since the last message."""
        self._in_each = False
        """Whether a message may be due in each tick, so that no tick shows other calls."""

    def expect_each(self, step_ns: int) -> None:
        """From now on, a message is due in each tick with that step."""
        self._step_ns, self._in_each, self._since = step_ns, True, 0
        self._gaps.extend([1] * ALIKE)

    def is_next(self, step_ns: int) -> bool:
        """Whether a message is due in the next tick, if it has that step."""
        is_known = step_ns == self._step_ns and len(self._gaps) == ALIKE
        is_close = not self._in_each and self._since == 0
        return is_known and not is_close and {*self._gaps} == {self._since + 1}

    def may_be_next(self, step_ns: int) -> bool:
        """Whether a message may come in the next tick, or fewer than ALIKE have come so far."""
        if step_ns != self._step_ns or len(self._gaps) < ALIKE:
            return True
        return self._since + 1 >= min(self._gaps)

    def note(self, step_ns: int, *, messages: int, took_sec: float) -> None:
        """Learn from a tick: how many messages came in it, and how long it took in wall time."""
        if step_ns != self._step_ns:
            self._step_ns, self._in_each = step_ns, False
            self._gaps.clear()
        self._since += 1
        if not messages:
            return
        if messages == 1 and took_sec * 1e9 < QUICK_PART * self._since * step_ns:
            self._gaps.append(self._since)
        else:
            self._gaps.clear()
        self._since = 0
