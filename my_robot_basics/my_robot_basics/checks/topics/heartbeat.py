"""Whether a node keeps running while it waits for something, by a topic on which it counts.

A node may be silent because it blocks, or because the machine is busy. It blocks if it is silent
in enough free time, or if its silence does not end while the notebook answers many requests. If a
long pause without free time ends, the result is in doubt.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.checks.topics.topics import Topic
from my_robot_basics.exchange import node_troubles
from my_robot_basics.exchange.asking import wait_for_turn
from my_robot_basics.feedback.errors import CheckFailed, Starved
from my_robot_basics.graph.stop_reasons import what_raised
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

BEATS, SPAN_SEC = 12, 1.2
"""How many beats are enough, and in how many seconds at least: a node that publishes counts ahead
of time runs out of them by then."""
STILL_SEC = 0.8
"""How long a silence is at least, in seconds of free time."""
LOOKS = 8
"""How many requests the notebook answers during a silence, at least."""
BUSY_SEC, BUSY_LOOKS = 10.0, 40
"""The same two limits if there is no free time, the first in seconds of wall time."""
LONG_SEC, LONG_LOOKS = 2.5, 10
"""A pause that ends after so many seconds of wall time and so many answers is in doubt."""
MOST_TIMES = 4.0
"""Such a pause is fine if it is less than so many times as long as a pause after it."""
NAMED_LOOKS = 3
"""After so many answers, the notebook is asked which line of a callback blocks the node."""
LOOK_SEC = 0.1
"""How long to wait for a beat before the notebook is asked again, in seconds."""
COUNTS_SEC, RATE_SEC = 2.0, 2.0
"""How long to wait for a first beat, in seconds of free time; how long to measure the rate, in
seconds of the robot's time."""
ROUND, ROUNDS = 4, 3
"""How many pauses a round has, and how many rounds there are. A round begins with a message to the
node: its first two pauses show whether that blocks the node, and the others show the machine."""
STALL_SEC, STALL_TIMES = 0.4, 2.0
"""A callback blocks if, in each round, the longer of the first two pauses has at least so many
seconds, and is at least so many times as long as every pause that shows the machine."""
PERIOD_SEC, STALL_FREE_SEC = 0.1, 0.4
"""This is sure if these pauses, less a period each, have STALL_FREE_SEC of free time together."""
SURE_SEC, SURE_TIMES = 0.8, 4.0
"""It is also sure with these limits in place of STALL_SEC and STALL_TIMES: a busy machine does not
make the time that a node needs for a message so long. Else, it is in doubt."""


@dataclass(frozen=True)
class _Pause:
    """The time until a beat, or until the silence has lasted long enough."""

    sec: float
    free_sec: float
    """How many seconds of it were free time."""
    is_over: bool
    """Whether the beat has come."""
    is_long: bool
    """Whether it is long enough to be in doubt."""


class Heartbeat:
    """A topic on which a node counts at 10 Hz while it does not block; each message is a beat."""

    def __init__(self, watcher: Watcher, recorder: Recorder) -> None:
        self._watcher, self._recorder = watcher, recorder
        self.doubt: type[CheckFailed] = CheckFailed
        """What to raise if `goes_on` is False: Starved if the machine may be to blame."""
        self.blocking_line = ''
        """The line of a callback during the last long pause, if there was one."""

    def goes_on(self, send: Callable[[], None] = lambda: None) -> bool:
        """Whether the node counts now, without a silence.

        `send()` sends the node a message, after a beat. It is called again only if the message
        before seems to block the node, because each may block a thread of the node for ever.
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
        """Whether later pauses are nearly as long as a long one: then the machine explains it."""
        later = [self._pause() for _ in range(BEATS)]
        if not all(each.is_over for each in later):
            return False
        # the machine may have been busier during the long pause than it is now
        self.doubt = Starved
        return sec < MOST_TIMES * max(each.sec for each in later)

    def _pause(self) -> _Pause:
        """Wait for a beat, or until this is a silence."""
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
            # a beat that comes during this request is received by the next spin
            wait_for_turn()
            looks += 1
            if looks == NAMED_LOOKS:  # at the end of the pause, the callback may have returned
                lines = map(node_troubles.blocking_line, self._recorder.publishers())
                self.blocking_line = next(filter(None, lines), self.blocking_line)


def record(watcher: Watcher, beats: Recorder) -> Recording | None:
    """Record a count for RATE_SEC of the robot's time.

    Return None if the count stands still, or if a callback of its node has raised: later checks
    report what the node waits for, and what it raised.
    """
    before = len(beats.received)
    counts = watcher.spin_until_free(lambda: len(beats.received) > before, free_sec=COUNTS_SEC)
    if not counts or what_raised(beats.publishers()):
        return None
    return Topic(beats.topic_name).record(seconds=RATE_SEC)


def _stalls(
    pauses: Sequence[_Pause], least_sec: float = STALL_SEC, times: float = STALL_TIMES
) -> bool:
    """Whether the message of each round so far blocked the node; see STALL_SEC."""
    longest, others = _by_round(pauses)
    shortest = min((each.sec for each in longest), default=least_sec)
    return shortest >= least_sec and shortest >= times * max(
        (each.sec for each in others), default=0.0
    )


def _is_sure(pauses: Sequence[_Pause]) -> bool:
    """Whether the pauses of a node that stalls cannot come from a busy machine; see SURE_SEC."""
    free_sec = sum(max(0.0, each.free_sec - PERIOD_SEC) for each in _by_round(pauses)[0])
    return free_sec >= STALL_FREE_SEC or _stalls(pauses, SURE_SEC, SURE_TIMES)


def _by_round(pauses: Sequence[_Pause]) -> tuple[list[_Pause], list[_Pause]]:
    """The longer of each round's first two pauses, and the pauses that show the machine."""
    rounds = [pauses[first : first + ROUND] for first in range(0, len(pauses), ROUND)]
    longest = [max(round_[:2], key=lambda each: each.sec) for round_ in rounds]
    return longest, [each for round_ in rounds for each in round_[2:]]
