"""A topic on a driven clock: tick until a message comes, and see that the node follows."""

import statistics
import time
from typing import NamedTuple

from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.clock.due_ticks import QUICK_PART, DueTicks
from my_robot_basics.checks.clock.inconclusive import Inconclusive, NoMessage
from my_robot_basics.checks.recordings.rates import AT_ONCE_SEC
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.topics.wall_recording import IGNORES
from my_robot_basics.graph.watcher import Watcher

SETTLE_SEC = 0.05
"""How long the clock is held at first, in wall time: a message may still be on its way."""
FIRST_MESSAGE_SEC = 20.0
"""How long to tick until a message comes, in seconds of the robot's time."""
SUSPICIOUS_TICKS = 30
"""So many ticks without a message may mean that a node ignores the clock: a tick takes only a
millisecond or two of wall time."""
PATIENT_SEC = 0.002
"""How long a thread that sleeps on the clock may take to wake up and to publish."""
OVERRUNS = 'its callback takes longer than its period'


class _Tick(NamedTuple):
    """What happened in one tick."""

    took_sec: float
    """How long the tick took, in wall time."""
    messages: int
    was_due: bool
    """Whether a message was due: the rest of its callback then takes time of the next tick."""


class DrivenTopic:
    """Receives the messages of a topic while the clock is driven.

    A node that ignores the clock still publishes while the clock is held. A plain timer, whose
    messages come in step with the ticks, is not checked for that.
    """

    def __init__(
        self, watcher: Watcher, recorder: Recorder, clock: SimulatedClock, *, hold_sec: float
    ) -> None:
        """`hold_sec`: how long to hold the clock to see whether messages stop, in wall time."""
        self.recorder, self.clock = recorder, clock
        self._watcher, self._hold_sec = watcher, hold_sec
        self._has_stood = False
        self._patient_sec = 0.0
        self._due: DueTicks | None = DueTicks()
        """None if each tick is acknowledged: callbacks take long, or threads publish."""
        self._ticks: list[_Tick] = []
        self._hold(SETTLE_SEC)

    def expect_follows(self) -> None:
        """Hold the clock, in the first call only. Raises Inconclusive if messages still come."""
        if not self._has_stood:
            self._has_stood = True
            self._hold(self._hold_sec)

    def wait_for_threads(self) -> None:
        """From now on, wait PATIENT_SEC after each tick: a thread does not acknowledge ticks."""
        self._patient_sec = PATIENT_SEC
        self._due = None

    def expect_in_each_tick(self, step_ns: int) -> bool:
        """From now on, a message is due in each tick with this step, until one has another step.

        Returns False, and changes nothing, if each tick is acknowledged.
        """
        if self._due is not None:
            self._due.expect_each(step_ns)
        return self._due is not None

    def tick(self, step_ns: int) -> int:
        """Move the clock, and receive what the node publishes then. Raises Inconclusive.

        Returns how many messages came.
        """
        received = self.recorder.received
        before, start = len(received), time.monotonic()
        is_due = self._due is not None and self._due.is_next(step_ns)
        may_be_due = self._due is None or self._due.may_be_next(step_ns)
        self.clock.tick(step_ns, until=(lambda: len(received) > before) if is_due else None)
        if not is_due:
            self.recorder.take_all()
        if may_be_due and len(received) == before:
            # a request may have overtaken the tick: then the second answer comes before the timer
            self.clock.acknowledge(questions=1)
            self.recorder.take_all()
        took_sec = time.monotonic() - start
        if self._patient_sec:
            self._watcher.spin_for(self._patient_sec)
        messages = len(received) - before
        self._ticks.append(_Tick(took_sec, messages, is_due))
        if self._due is not None:
            self._due.note(step_ns, messages=messages, took_sec=took_sec)
        return messages

    def expect_keeps_up(self, ticks: int, step_ns: int) -> None:
        """Raise Inconclusive if callbacks took longer than a period in the last ticks.

        A busy machine makes all ticks slow: so only the time counts that a message adds to a tick.
        """
        last = self._ticks[-ticks:]
        if any(tick.was_due for tick in last):
            if sum(tick.took_sec for tick in last) > QUICK_PART * ticks * step_ns / 1e9:
                self._due = None  # so the next ticks are acknowledged, and show more
            return
        with_one = [tick.took_sec for tick in last if tick.messages]
        without = [tick.took_sec for tick in last if not tick.messages]
        if with_one and without:
            works_sec = statistics.median(with_one) - statistics.median(without)
            # not divided by the messages: one callback may publish several
            if works_sec > len(last) * step_ns / 1e9 / len(with_one):
                raise Inconclusive(OVERRUNS)

    def tick_to_message(self, step_ns: int) -> int:
        """Tick until a message arrives; return how many ticks that took. Raises Inconclusive."""
        before = len(self.recorder.received)
        for ticks in range(1, round(FIRST_MESSAGE_SEC * 1e9 / step_ns) + 1):
            self.tick(step_ns)
            if len(self.recorder.received) > before:
                return ticks
            if ticks == SUSPICIOUS_TICKS:
                self.expect_follows()
        raise NoMessage(f"no message arrived in {FIRST_MESSAGE_SEC:g} s of the robot's time")

    def _hold(self, seconds: float) -> None:
        """Hold the clock. Raises Inconclusive if messages still come.

        Messages in the first half don't count: a thread may be late. Nor do several at once from
        one callback.
        """
        since_ns = time.time_ns()
        late_ns = since_ns + round(seconds * 1e9 / 2)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.clock.hold(min(seconds, 0.05))
            is_late = self.recorder.count_since(late_ns) > 0
            if is_late and self.recorder.seconds_since(since_ns) > AT_ONCE_SEC:
                raise Inconclusive(IGNORES)
