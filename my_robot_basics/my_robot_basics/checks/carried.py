"""What becomes of messages that go through a node one at a time: each comes out at once, once."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from my_robot_basics.checks.ears import Ears
from my_robot_basics.checks.pressure import Stopwatch
from my_robot_basics.checks.variety import PLAIN, Sent
from my_robot_basics.checks.watcher import Watcher

ON_TIME_SEC = 1.0
"""How long a message may take. Who passes it on by a timer is in time, too."""
PATIENCE_TIMES, LEAST_SEC = 10.0, 0.2
"""Once some came out, no more than so many times as long as the slowest of them, and that."""
QUIET_SEC = 0.1
"""How long to listen for a second copy."""
TIMES = 120
"""Messages in a row that have to come out: one that is left out each hundredth time is among
them. …"""
FEWEST = 10
"""… So many will do for a node that is slow, …"""
LONG_SEC, LONGEST_SEC = 4.0, 6.0
"""… After so much time that was free, or in all."""
MOST_LATE = 4
"""So many tell enough: each is waited for, and a BEST_EFFORT end may lose one now and then."""
CROWD = 50
"""With so many messages of others while one is waited for, the queue overflows without anybody's
fault: …"""
MOST_CROWDED_OUT = 20
"""… So many such losses are no chance, either."""
FEWEST_COPIES = 2
"""Messages of which there are copies."""
RECENT = 20
"""A copy is one of so many that came out last."""
PAIR_GAP_SEC = 0.01
"""Two messages so near to each other: a node that keeps only the latest for a timer loses one."""
WHOLE_PAIRS, MOST_TORN = 2, 6
"""So many pairs have to come out, before so many did not: a queue of depth 1 may lose one."""
PAUSE_SEC = 1.1
PAUSES = 3
CALLBACK = 'publish in every call of the callback'


@dataclass(frozen=True)
class Carried:
    """What was amiss: how many messages were late, which of them never came, and what came twice.

    Each that is late was not there before the next one was sent.
    """

    late: int = 0
    lost: tuple[str, ...] = ()
    """The kind of each message that never came out."""
    copies: int = 1
    """How often one came out at most."""

    def is_whole(self) -> bool:
        """Whether enough came out in time, and each once."""
        return not self.late and self.copies == 1

    def fault(self) -> tuple[str, str]:
        """What was seen, and what to try."""
        if self.lost and (len(self.lost) > 1 or self.late == len(self.lost)):
            kinds = set(self.lost)
            if len(kinds) == 1 and PLAIN not in kinds:
                return f'messages that are not republished: those {kinds.pop()}', (
                    f'{CALLBACK}, whatever the message holds'
                )
            return 'messages that are not republished', f'{CALLBACK}: some messages are left out'
        if self.late:
            return 'a message that is republished only when the next one arrives', (
                'publish the message that your callback is given, not the one before'
            )
        return f'a message that is republished {self.copies} times', (
            'subscribe once, and publish once in each call of the callback'
        )


class Passage:
    """Publishes on one topic and sees what comes out on another one."""

    def __init__(
        self,
        watcher: Watcher,
        ears: Ears,
        *,
        publish: Callable[[Any], None],
        is_same: Callable[[Any, Any], bool],
    ) -> None:
        """`is_same(heard, sent)` tells whether one is the other. Only what comes now counts."""
        self._watcher, self._ears = watcher, ears
        self._publish, self._is_same = publish, is_same
        self._seen = len(ears.heard)
        self._waiting: list[Sent] = []
        self._out: list[Sent] = []
        self._copies: list[int] = []
        """How often each of those came out."""
        self._others = 0
        self._slowest_sec = 0.0

    def carry(self, messages: Iterator[Sent]) -> Carried:
        """Publish each once the one before has come out or is late, until enough came in a row.

        The others of a crowd may push one out of a queue: such a loss counts for nothing.
        """
        late = in_a_row = crowded_out = 0
        watch = Stopwatch()
        while in_a_row < TIMES and late < MOST_LATE:
            is_long = watch.free_sec() >= LONG_SEC or watch.wall_sec() >= LONGEST_SEC
            if is_long and in_a_row >= FEWEST:
                break
            others, sent = self._others, next(messages)
            if self._send(sent):
                in_a_row += 1
            elif self._others - others >= CROWD and crowded_out < MOST_CROWDED_OUT:
                crowded_out += 1
                self._waiting.remove(sent)
            else:
                late, in_a_row, watch = late + 1, 0, Stopwatch()
        self._watcher.spin_for(QUIET_SEC)
        self._take()
        doubled = [number for number in self._copies if number > 1]
        copies = min(doubled) if len(doubled) >= FEWEST_COPIES else 1
        if late < MOST_LATE:
            return Carried(copies=copies)
        return Carried(late=late, lost=tuple(sent.kind for sent in self._waiting), copies=copies)

    def loses_one_of_two(self, messages: Iterator[Sent]) -> bool:
        """Whether of two messages in quick succession mostly one alone comes out."""
        whole = torn = 0
        while whole < WHOLE_PAIRS and torn < MOST_TORN:
            first = next(messages)
            self._waiting = [first]
            self._publish(first.message)
            self._watcher.spin_for(PAIR_GAP_SEC)
            self._send(next(messages))
            is_whole = not self._waiting
            whole, torn = whole + is_whole, torn + (not is_whole)
        return whole < WHOLE_PAIRS

    def loses_after_a_pause(self, messages: Iterator[Sent]) -> bool:
        """Whether a message that comes after a pause never comes out."""
        for _ in range(PAUSES):
            self._watcher.spin_for(PAUSE_SEC)
            if self._send(next(messages)):
                return False
        return True

    def _send(self, sent: Sent) -> bool:
        """Publish it; whether it has come out in time."""
        self._waiting.append(sent)
        self._publish(sent.message)

        def is_out() -> bool:
            self._take()
            return not any(each is sent for each in self._waiting)

        patience_sec, watch = ON_TIME_SEC, Stopwatch()
        if self._slowest_sec:
            patience_sec = max(LEAST_SEC, PATIENCE_TIMES * self._slowest_sec)
        if not self._watcher.spin_until_free(is_out, free_sec=min(patience_sec, ON_TIME_SEC)):
            return False
        self._slowest_sec = max(self._slowest_sec, watch.wall_sec())
        return True

    def _take(self) -> None:
        """Sort what was received: the first of those that are waited for, a copy, or another's."""
        heard = self._ears.messages()[self._seen :]
        self._seen += len(heard)
        for message in heard:
            for place, sent in enumerate(self._waiting):
                if self._is_same(message, sent.message):
                    del self._waiting[place]
                    self._out.append(sent)
                    self._copies.append(1)
                    break
            else:
                self._count(message)

    def _count(self, message: Any) -> None:
        for place in reversed(range(max(0, len(self._out) - RECENT), len(self._out))):
            if self._is_same(message, self._out[place].message):
                self._copies[place] += 1
                return
        self._others += 1
