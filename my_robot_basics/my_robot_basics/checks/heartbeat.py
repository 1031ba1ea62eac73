"""Whether a node goes on while something else takes its time, by a topic on which it counts.

A machine that is short of time is no node that waits: where no time is free, only a pause counts
that is far longer than those after it. The notebook has to answer questions meanwhile.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.exchange.asking import wait_for_turn
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

BEATS, SPAN_SEC = 12, 1.2
"""So many, in no less time, are enough: a node that counts ahead has to go on then; …"""
STILL_SEC = 0.8
"""… a silence is so long, of time that was free, and …"""
LOOKS = 8
"""… holds so many questions that the notebook answered. …"""
BUSY_SEC, BUSY_LOOKS = 2.5, 10
"""… Where no time is free, so long a pause is a silence, too, …"""
MOST_TIMES = 4.0
"""… unless it is less than so many times as long as another one, once the node counts again, …"""
AGAIN_TIMES = 3
"""… which it has to do in so many times as much of both."""
LOOK_SEC = 0.1
ROUND, ROUNDS = 4, 3
"""A round of beats begins with a message: the first two pauses show what the node makes of it, and
those behind show the machine. So many rounds, in which …"""
STALL_SEC, STALL_TIMES = 0.4, 2.0
"""… each message holds it up for so long, and for so many times as long as any other pause, are
no chance: it waits a while each time, in a callback."""


@dataclass(frozen=True)
class _Pause:
    """The time before a beat, or until enough is known without one."""

    sec: float
    is_over: bool
    """Whether the beat has come."""
    was_free: bool = False
    """Whether enough of the time was free."""


class Heartbeat:
    """A topic on which a node counts at 10 Hz while it is alive."""

    def __init__(self, watcher: Watcher, recorder: Recorder) -> None:
        self._watcher, self._recorder = watcher, recorder

    def goes_on(self, send: Callable[[], None] = lambda: None) -> bool:
        """Whether it counts now, without a silence.

        `send()` sends the node a message, after a beat: again only if that seems to hold it up,
        because each may keep a thread of the node for good.
        """
        watch, pauses, sent = Stopwatch(), [self._pause()], 0
        while pauses[-1].is_over and (len(pauses) <= BEATS or watch.wall_sec() < SPAN_SEC):
            if sent < ROUNDS and len(pauses) == 1 + ROUND * sent and _stalls(pauses[1:]):
                send()
                sent += 1
            pauses.append(self._pause())
        last = pauses[-1]
        if last.is_over:
            return not (sent == ROUNDS and _stalls(pauses[1 : 1 + ROUND * ROUNDS]))
        return not last.was_free and self._is_usual(last)

    def _is_usual(self, pause: _Pause) -> bool:
        """Whether a machine that is short of time explains a pause, by those that come later."""
        rest = self._pause(times=AGAIN_TIMES)
        if not rest.is_over:
            return False
        later_sec = max(self._pause().sec for _ in range(BEATS))
        return pause.sec + rest.sec < MOST_TIMES * later_sec

    def _pause(self, *, times: int = 1) -> _Pause:
        """Wait for a beat, no longer than until it is known that this is a silence."""
        before, watch, looks = len(self._recorder.received), Stopwatch(), 0
        while True:
            if self._watcher.spin_until(
                lambda: len(self._recorder.received) > before, timeout_sec=LOOK_SEC
            ):
                return _Pause(watch.wall_sec(), is_over=True)
            wait_for_turn()
            looks += 1
            sec = watch.wall_sec()
            if looks >= LOOKS and watch.free_sec() >= STILL_SEC:
                return _Pause(sec, is_over=False, was_free=True)
            if looks >= times * BUSY_LOOKS and sec >= times * BUSY_SEC:
                return _Pause(sec, is_over=False)


def _stalls(pauses: Sequence[_Pause]) -> bool:
    """Whether the message of each round so far held the node up for a while."""
    rounds = [pauses[first : first + ROUND] for first in range(0, len(pauses), ROUND)]
    shortest = min((max(each.sec for each in round_[:2]) for round_ in rounds), default=STALL_SEC)
    others = max((each.sec for round_ in rounds for each in round_[2:]), default=0.0)
    return shortest >= STALL_SEC and shortest >= STALL_TIMES * others
