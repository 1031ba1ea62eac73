"""A topic on the clock that a check drives: tick until a message comes, see that it follows."""

import statistics
import time
from typing import NamedTuple

from my_robot_basics.checks.clock import SimulatedClock
from my_robot_basics.checks.due_ticks import QUICK_PART, DueTicks
from my_robot_basics.checks.inconclusive import Inconclusive, NoMessage
from my_robot_basics.checks.rates import AT_ONCE_SEC
from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.checks.wall_recording import IGNORES
from my_robot_basics.graph.watcher import Watcher

SETTLE_SEC = 0.05
"""So long does the clock stand still first: a message may be under way."""
FIRST_MESSAGE_SEC = 20.0
SUSPICIOUS_TICKS = 30
"""A tick takes a millisecond or two: of a node that ignores the clock, messages are far apart."""
PATIENT_SEC = 0.002
"""What a thread that sleeps on the clock takes to wake up and to publish."""
OVERRUNS = 'its callback takes longer than its period'


class _Tick(NamedTuple):
    """One tick, as it went."""

    took_sec: float
    """Of wall time."""
    messages: int
    was_due: bool
    """Whether a message was: what its callback does after it is in the time of the next tick."""


class DrivenTopic:
    """What is received while the clock is driven.

    A node that ignores the clock goes on while that stands still. A plain timer, whose messages
    come as the ticks do, is not asked to prove that it stands still, too.
    """

    def __init__(
        self, watcher: Watcher, recorder: Recorder, clock: SimulatedClock, *, hold_sec: float
    ) -> None:
        """`hold_sec`: how long the clock stands still to see whether messages do."""
        self.recorder, self.clock = recorder, clock
        self._watcher, self._hold_sec = watcher, hold_sec
        self._has_stood = False
        self._patient_sec = 0.0
        self._due: DueTicks | None = DueTicks()
        """None where each tick asks: its callbacks take long, or threads publish."""
        self._ticks: list[_Tick] = []
        self._hold(SETTLE_SEC)

    def expect_follows(self) -> None:
        """Let the clock stand still, once. Raises Inconclusive where messages go on."""
        if not self._has_stood:
            self._has_stood = True
            self._hold(self._hold_sec)

    def wait_for_threads(self) -> None:
        """Wait a little after each tick from now on: a thread of the node acknowledges none."""
        self._patient_sec = PATIENT_SEC
        self._due = None

    def tick(self, step_ns: int) -> None:
        """Move the clock, and receive what that brings. Raises Inconclusive."""
        received = self.recorder.received
        before, start = len(received), time.monotonic()
        is_due = self._due is not None and self._due.is_next(step_ns)
        self.clock.tick(step_ns, until=(lambda: len(received) > before) if is_due else None)
        took_sec = time.monotonic() - start
        if not is_due:
            self.recorder.take_all()
        if self._patient_sec:
            self._watcher.spin_for(self._patient_sec)
        messages = len(received) - before
        self._ticks.append(_Tick(took_sec, messages, is_due))
        if self._due is not None:
            self._due.note(step_ns, messages=messages, took_sec=took_sec)

    def expect_keeps_up(self, ticks: int, step_ns: int) -> None:
        """In the last ticks, callbacks that publish took less than a period. Raises Inconclusive.

        How busy the machine is makes all ticks slow: only what a message adds to one counts.
        """
        last = self._ticks[-ticks:]
        if any(tick.was_due for tick in last):
            if sum(tick.took_sec for tick in last) > QUICK_PART * ticks * step_ns / 1e9:
                self._due = None  # the next ones tell
            return
        with_one = [tick.took_sec for tick in last if tick.messages]
        without = [tick.took_sec for tick in last if not tick.messages]
        if with_one and without:
            works_sec = statistics.median(with_one) - statistics.median(without)
            if works_sec > len(last) * step_ns / 1e9 / sum(tick.messages for tick in last):
                raise Inconclusive(OVERRUNS)

    def tick_to_message(self, step_ns: int) -> int:
        """Tick until a message arrives; how many ticks it took. Raises Inconclusive."""
        before = len(self.recorder.received)
        for ticks in range(1, round(FIRST_MESSAGE_SEC * 1e9 / step_ns) + 1):
            self.tick(step_ns)
            if len(self.recorder.received) > before:
                return ticks
            if ticks == SUSPICIOUS_TICKS:
                self.expect_follows()
        raise NoMessage(f"no message arrived in {FIRST_MESSAGE_SEC:g} s of the robot's time")

    def _hold(self, seconds: float) -> None:
        """Let the clock stand still. Raises Inconclusive where messages go on all the same.

        A callback may send several, and a thread that is late has some to send at first.
        """
        since_ns = time.time_ns()
        late_ns = since_ns + round(seconds * 1e9 / 2)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.clock.hold(min(seconds, 0.05))
            is_late = self.recorder.count_since(late_ns) > 0
            if is_late and self.recorder.seconds_since(since_ns) > AT_ONCE_SEC:
                raise Inconclusive(IGNORES)
