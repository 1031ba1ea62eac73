"""What becomes of messages that go through a node one at a time: each comes out at once, once."""

import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from my_robot_basics.checks.enough import fewest_in_a_row
from my_robot_basics.checks.pairs import GAP_SEC, Pairs
from my_robot_basics.checks.recorder import Recorder
from my_robot_basics.checks.relay_faults import RelayFaults
from my_robot_basics.checks.variety import Sent
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

ON_TIME_SEC = 1.0
"""How long a message may take. A node that republishes by a timer is in time, too."""
TIMEOUT_FACTOR, LEAST_SEC = 10.0, 0.2
"""Once some came out, so many times as long as the slowest of them, and that, tell that a machine
is busy, a queue has overflowed, or a message is late: that one has ON_TIME_SEC more."""
QUIET_SEC = 0.1
"""How long to listen for a second copy."""
MOST_SEC, LAST_SEC = 12.0, 20.0
"""After so long, of wall time, what was seen decides, and then pairs and pauses end, too:
*Validate* gives a cell 30 s."""
FEWEST_LOST = 2
"""So many that never came out are no coincidence if later ones did."""
MOST_LATE = 4
"""So many tell enough: each is waited for, and a BEST_EFFORT end may lose one now and then."""
FLOOD = 50
"""With so many messages of others while one is waited for, the queue overflows without anybody's
fault: …"""
MOST_PUSHED_OUT = 20
"""… So many such losses are no coincidence, either."""
FEWEST_INVENTED = 3
"""Messages that nobody sent: one or two may have been on their way before the check listened."""
RECENT = 20
"""A copy is one of so many that came out last."""
PAUSE_SEC = 1.1
PAUSES = 3


class Passage:
    """Publishes on one topic and sees what comes out on another one."""

    def __init__(
        self,
        watcher: Watcher,
        recorder: Recorder,
        *,
        publish: Callable[[Any], None],
        what: Callable[[Any], Any],
        earlier: Any = None,
    ) -> None:
        """`what(message)` is the same of two messages that are one. Only what comes now counts.

        Of the `earlier` message, which was sent again and again, a slow node may still have some
        in its queue: they come out before all others.
        """
        self._watcher, self._recorder = watcher, recorder
        self._publish, self._what = publish, what
        self._earlier = None if earlier is None else what(earlier)
        self._seen = len(recorder.received)
        self._waiting: list[Sent] = []
        self._out: list[tuple[Sent, int]] = []
        self._copies: list[int] = []
        """How often each of those came out."""
        self._own: set[Any] = set()
        """What of each message that was published here."""
        self._others: list[tuple[Any, int]] = []
        self._pushed_out, self._slowest_sec = 0, 0.0
        self._watch, self._began_ns = Stopwatch(), time.time_ns()

    def carry(self, messages: Iterator[Sent]) -> RelayFaults:
        """Publish each once the one before has come out or is late, until enough came in a row.

        The others of a flood may push one out of a queue: such a loss counts for nothing.
        """
        late = in_a_row = 0
        row = Stopwatch()
        while in_a_row < fewest_in_a_row(row) and late < MOST_LATE:
            # a node that swaps two has one in time, and none in a row
            if in_a_row > 1 and self._is_over(MOST_SEC):
                break
            others, sent = len(self._others), next(messages)
            if self._send(sent):
                in_a_row += 1
            elif len(self._others) - others >= FLOOD and self._pushed_out < MOST_PUSHED_OUT:
                self._pushed_out += 1
                self._waiting.remove(sent)
            # in a queue of depth 1, the next would push it out
            elif self._wait_for(sent, free_sec=ON_TIME_SEC):
                in_a_row += 1
            else:
                late, in_a_row, row = late + 1, 0, Stopwatch()
        self._watcher.spin_for(QUIET_SEC)
        copies = self.copies()
        is_enough = in_a_row >= fewest_in_a_row(row) or len(self._waiting) < FEWEST_LOST
        if late < MOST_LATE and is_enough:
            return RelayFaults(copies=copies)
        return RelayFaults(
            late=late, lost=tuple(sent.kind for sent in self._waiting), copies=copies
        )

    def copies(self) -> int:
        """How often each message came out so far: more than once, if one did."""
        self._take()
        doubled = [number for number in self._copies if number > 1]
        # one that was pushed out of a queue may have come after all, equal to another
        return min(doubled) if len(doubled) > bool(self._pushed_out) else 1

    def invents(self, sent: Sequence[tuple[Any, int]]) -> bool:
        """Whether messages came out that are not among those that anybody `sent`, with the time.

        What another publisher sent before the first that was received here is not known: that
        comes within ON_TIME_SEC, or nobody else publishes.
        """
        known = {self._what(message) for message, _ in sent}
        of_others_ns = (ns for message, ns in sent if self._what(message) not in self._own)
        received_ns = min(next(of_others_ns, 0), self._began_ns + round(ON_TIME_SEC * 1e9))
        since_ns = received_ns + round(LEAST_SEC * 1e9)
        invented = [
            message
            for message, sent_ns in self._others
            if sent_ns > since_ns and self._what(message) not in known
        ]
        return len(invented) >= FEWEST_INVENTED

    def loses_one_of_two(self, messages: Iterator[Sent]) -> bool:
        """Whether of two messages in quick succession mostly one alone comes out."""
        pairs = Pairs()
        while (told := pairs.tell()) is None and not self._is_over(LAST_SEC):
            first, gap = next(messages), Stopwatch()
            self._waiting = [first]
            self._let_in(first)
            self._watcher.spin_for(GAP_SEC)
            gap_sec = gap.wall_sec()
            self._send(next(messages))
            out_sec = 0.0 if self._waiting else (self._out[-1][1] - self._out[-2][1]) / 1e9
            pairs.count(is_whole=not self._waiting, gap_sec=gap_sec, out_sec=out_sec)
        return pairs.tell_at_last() if told is None else told

    def loses_after_a_pause(self, messages: Iterator[Sent]) -> bool:
        """Whether a message that comes after a pause never comes out."""
        for number in range(PAUSES):
            if number >= FEWEST_LOST and self._is_over(LAST_SEC):
                break
            self._watcher.spin_for(PAUSE_SEC)
            if self._send(next(messages)):
                return False
        return True

    def _is_over(self, most_sec: float) -> bool:
        return self._watch.wall_sec() >= most_sec

    def _send(self, sent: Sent) -> bool:
        """Publish it; whether it has come out in time."""
        self._waiting.append(sent)
        self._let_in(sent)
        timeout_sec, watch = ON_TIME_SEC, Stopwatch()
        if self._slowest_sec:
            timeout_sec = max(LEAST_SEC, TIMEOUT_FACTOR * self._slowest_sec)
        if not self._wait_for(sent, free_sec=min(timeout_sec, ON_TIME_SEC)):
            return False
        self._slowest_sec = max(self._slowest_sec, watch.wall_sec())
        return True

    def _wait_for(self, sent: Sent, *, free_sec: float) -> bool:
        """Wait until it has come out, for so much time that was free; whether it has."""

        def is_out() -> bool:
            self._take()
            return not any(each is sent for each in self._waiting)

        return self._watcher.spin_until_free(is_out, free_sec=free_sec)

    def _let_in(self, sent: Sent) -> None:
        self._own.add(self._what(sent.message))
        self._publish(sent.message)

    def _take(self) -> None:
        """Sort what was received: the first of those that are waited for, a copy, or another's."""
        received = self._recorder.received[self._seen :]
        self._seen += len(received)
        for message, sent_ns in received:
            for place, sent in enumerate(self._waiting):
                if self._what(message) == self._what(sent.message):
                    del self._waiting[place]
                    self._out.append((sent, sent_ns))
                    self._copies.append(1)
                    break
            else:
                self._count(message, sent_ns)

    def _count(self, message: Any, sent_ns: int) -> None:
        for place in reversed(range(max(0, len(self._out) - RECENT), len(self._out))):
            if self._what(message) == self._what(self._out[place][0].message):
                self._copies[place] += 1
                return
        if self._out or self._what(message) != self._earlier:
            self._others.append((message, sent_ns))
