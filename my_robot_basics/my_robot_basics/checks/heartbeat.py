"""Whether a node goes on while something else takes its time, by a topic on which it counts.

A machine that is short of time is no node that waits. Time that was free tells the two apart, and
so does a silence in which the notebook answers many questions and that does not end. A long pause
that ends, with no free time in it, is a doubt.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.checks.recording import Recording
from my_robot_basics.checks.topics import Topic
from my_robot_basics.exchange.asking import wait_for_turn
from my_robot_basics.feedback.errors import CheckFailed, Starved
from my_robot_basics.graph.raised import what_raised
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

BEATS, SPAN_SEC = 12, 1.2
"""So many, in no less time, are enough: a node that counts ahead has to go on then; …"""
STILL_SEC = 0.8
"""… a silence is so long, of time that was free, and …"""
LOOKS = 8
"""… holds so many questions that the notebook answered. …"""
BUSY_SEC, BUSY_LOOKS = 10.0, 40
"""… If no time is free, a silence is so long, and holds so many. …"""
LONG_SEC, LONG_LOOKS = 2.5, 10
"""… A pause that ends after so much of both is a doubt, …"""
MOST_TIMES = 4.0
"""… unless it is less than so many times as long as another one after it."""
LOOK_SEC = 0.1
COUNTS_SEC, RATE_SEC = 2.0, 2.0
"""A count that goes on at all shows it in so much time that was free. Its rate is measured over so
many seconds of the robot's time."""
ROUND, ROUNDS = 4, 3
"""A round of beats begins with a message: the first two pauses show what the node makes of it, and
those behind show the machine. So many rounds, in which …"""
STALL_SEC, STALL_TIMES = 0.4, 2.0
"""… each message holds it up for so long, and for so many times as long as any other pause, mean
that it waits a while each time, in a callback, if …"""
PERIOD_SEC, STALL_FREE_SEC = 0.1, 0.4
"""… so much of these pauses, without a period of each, was free, or …"""
SURE_SEC, SURE_TIMES = 0.8, 4.0
"""… each was so long: a message takes a node some time, too, and a busy machine makes that longer,
but not as long as this."""


@dataclass(frozen=True)
class _Pause:
    """The time before a beat, or until enough is known without one."""

    sec: float
    free_sec: float
    """How much of it was free."""
    is_over: bool
    """Whether the beat has come."""
    is_long: bool
    """Whether it may have been a silence."""


class Heartbeat:
    """A topic on which a node counts at 10 Hz while it is alive."""

    def __init__(self, watcher: Watcher, recorder: Recorder) -> None:
        self._watcher, self._recorder = watcher, recorder
        self.doubt: type[CheckFailed] = CheckFailed
        """What to raise if it does not go on: Starved if the machine may be to blame."""

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
        if not pauses[-1].is_over:
            return False
        rounds = pauses[1 : 1 + ROUND * ROUNDS]
        if sent == ROUNDS and _stalls(rounds):
            if not _is_sure(rounds):
                self.doubt = Starved
            return False
        long = [each.sec for each in pauses if each.is_long]
        return not long or self._is_usual(max(long))

    def _is_usual(self, sec: float) -> bool:
        """Whether a long pause is explained by those that come later."""
        later = [self._pause() for _ in range(BEATS)]
        if not all(each.is_over for each in later):
            return False
        # a machine that was short of time then may have enough of it now
        self.doubt = Starved
        return sec < MOST_TIMES * max(each.sec for each in later)

    def _pause(self) -> _Pause:
        """Wait for a beat, no longer than until it is known that this is a silence."""
        before, watch, looks = len(self._recorder.received), Stopwatch(), 0
        while True:
            is_over = self._watcher.spin_until(
                lambda: len(self._recorder.received) > before, timeout_sec=LOOK_SEC
            )
            sec, free_sec = watch.wall_sec(), watch.free_sec()
            is_silence = (looks >= LOOKS and free_sec >= STILL_SEC) or (
                looks >= BUSY_LOOKS and sec >= BUSY_SEC
            )
            if is_over or is_silence:
                is_long = looks >= LONG_LOOKS and sec >= LONG_SEC
                return _Pause(sec, free_sec, is_over=is_over, is_long=is_long)
            # what comes while the notebook is asked is received by the next spin
            wait_for_turn()
            looks += 1


def record(watcher: Watcher, beats: Recorder) -> Recording | None:
    """Record a count for RATE_SEC of the robot's time, in which timers of the node run.

    Return None for a count that stands still, or whose node has raised: checks behind this one
    tell what the node waits for, and what it raised.
    """
    before = len(beats.received)
    counts = watcher.spin_until_free(lambda: len(beats.received) > before, free_sec=COUNTS_SEC)
    if not counts or what_raised(beats.publishers()):
        return None
    return Topic(beats.topic_name).record(seconds=RATE_SEC)


def _stalls(
    pauses: Sequence[_Pause], least_sec: float = STALL_SEC, times: float = STALL_TIMES
) -> bool:
    """Whether the message of each round so far held the node up for a while."""
    longest, others = _by_round(pauses)
    shortest = min((each.sec for each in longest), default=least_sec)
    return shortest >= least_sec and shortest >= times * max(
        (each.sec for each in others), default=0.0
    )


def _is_sure(pauses: Sequence[_Pause]) -> bool:
    """Whether a machine that is short of time is no reason why messages held the node up."""
    free_sec = sum(max(0.0, each.free_sec - PERIOD_SEC) for each in _by_round(pauses)[0])
    return free_sec >= STALL_FREE_SEC or _stalls(pauses, SURE_SEC, SURE_TIMES)


def _by_round(pauses: Sequence[_Pause]) -> tuple[list[_Pause], list[_Pause]]:
    """The longest pause after each round's message, and those that show the machine."""
    rounds = [pauses[first : first + ROUND] for first in range(0, len(pauses), ROUND)]
    longest = [max(round_[:2], key=lambda each: each.sec) for round_ in rounds]
    return longest, [each for round_ in rounds for each in round_[2:]]
