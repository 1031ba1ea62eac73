"""Send messages through a node one at a time: each must come out immediately, exactly once."""

import time
from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import Any

from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.checks.recordings.sleeping_callbacks import or_sleeps
from my_robot_basics.checks.relays.invented import has_invented
from my_robot_basics.checks.relays.pairs import GAP_SEC, Pairs
from my_robot_basics.checks.relays.pushed_out import MOST_AGAIN, PushedOut
from my_robot_basics.checks.relays.relay_faults import RelayFaults
from my_robot_basics.checks.relays.variety import VariedMessage
from my_robot_basics.feedback.errors import Starved
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

ON_TIME_SEC = 1.0
"""How long a message may take, in s of free time: enough for a node that republishes by timer."""
TIMEOUT_FACTOR, LEAST_SEC = 10.0, 0.2
"""Once one came out, the first timeout is TIMEOUT_FACTOR times the slowest so far, at least
LEAST_SEC. Then it may take ON_TIME_SEC more, unless others' messages may have pushed it out."""
QUIET_SEC = 0.1
"""How long to wait for a second copy of a message, in s of wall time."""
MOST_SEC, LAST_SEC = 12.0, 20.0
"""After MOST_SEC of wall time, `carry` decides on what it has seen; after LAST_SEC, so do the
tests with pairs and pauses. *Validate* gives a cell 30 s."""
FEWEST_LOST = 2
"""This many messages that never came out are no coincidence if later ones did."""
MOST_LATE = 4
"""This many late messages decide; a BEST_EFFORT endpoint may lose fewer without a fault."""
RECENT = 20
"""A message counts as a copy if it equals one of the last RECENT that came out."""
PAUSE_SEC, PAUSES = 1.1, 3


class Passage:
    """Publishes on one topic and observes what comes out on another one."""

    def __init__(
        self,
        watcher: Watcher,
        recorder: Recorder,
        *,
        publish: Callable[[Any], None],
        what: Callable[[Any], Hashable],
        others_publish: bool,
        earlier: Any = None,
    ) -> None:
        """`what(message)` is equal for equal messages. Only messages received from now on count.

        `others_publish`: whether nodes of others publish on the same topic. `earlier`: a message
        that was sent repeatedly before. A slow node may let it out from its queue more often.
        """
        self._watcher, self._recorder = watcher, recorder
        self._publish, self._what = publish, what
        self._earlier = None if earlier is None else what(earlier)
        self._seen = len(recorder.received)
        self._waiting: list[VariedMessage] = []
        self._out: list[tuple[Hashable, int]] = []
        self._copies: list[int] = []
        """How often each message of `_out` came out, less the times that it was sent again."""
        self._own: set[Hashable] = set()  # what was published here
        self._others: list[tuple[Hashable, int]] = []
        self._pushed_out, self._slowest_sec = PushedOut(others_publish), 0.0
        self._watch, self._began_ns = Stopwatch(), time.time_ns()

    def carry(self, messages: Iterator[VariedMessage]) -> RelayFaults:
        """Publish each message once the one before came out or is late, until enough in a row did.

        A message that others' messages may have pushed out of a queue is sent again.
        """
        late, in_a_row, row, pushed_out = 0, 0, Stopwatch(), self._pushed_out
        while in_a_row < pushed_out.fewest_in_a_row(row) and late < MOST_LATE:
            # a node that swaps two messages has one in time, but never two in a row
            if pushed_out.is_doubtful or (in_a_row > 1 and self._is_over(MOST_SEC)):
                break
            others, sent, watch = len(self._others), next(messages), Stopwatch()
            # wait for a late one: in a queue of depth 1, the next message would push it out
            if self._send(sent) or self._comes_out_later(sent, watch, others):
                in_a_row += 1
            else:
                late, in_a_row, row = late + 1, 0, Stopwatch()
        self._watcher.spin_for(QUIET_SEC)
        copies, lost = self.copies(), tuple(sent.kind for sent in self._waiting)
        is_enough = in_a_row >= pushed_out.fewest_in_a_row(row)
        if pushed_out.doubts(is_enough or late == MOST_LATE):
            lost += tuple(pushed_out.kinds)
            return RelayFaults(late=len(lost), lost=lost, doubt=Starved)
        if late < MOST_LATE and (is_enough or len(lost) < FEWEST_LOST):
            return RelayFaults(copies=copies)
        return RelayFaults(late=late, lost=lost, copies=copies)

    def copies(self) -> int:
        """How often the least repeated message came out so far; 1 if none was repeated."""
        self._take()
        doubled = [number for number in self._copies if number > 1]
        # a message that counts as pushed out may still come, and looks like a copy of its equal
        return min(doubled) if len(doubled) > bool(self._pushed_out.kinds) else 1

    def invents(self, sent: Sequence[tuple[Any, int]]) -> bool:
        """Whether messages came out that are not in `sent`: all messages and their send times."""
        contents = [(self._what(message), sent_ns) for message, sent_ns in sent]
        return has_invented(self._others, sent=contents, own=self._own, began_ns=self._began_ns)

    def loses_one_of_two(self, messages: Iterator[VariedMessage]) -> bool:
        """Whether mostly only one of two messages in quick succession comes out."""
        pairs = Pairs()
        while (told := pairs.verdict()) is None and not self._is_over(LAST_SEC):
            first, gap = next(messages), Stopwatch()
            self._waiting = [first]
            self._let_in(first)
            self._watcher.spin_for(GAP_SEC)
            gap_sec = gap.wall_sec()
            self._send(next(messages))
            out_sec = 0.0 if self._waiting else (self._out[-1][1] - self._out[-2][1]) / 1e9
            pairs.count(is_whole=not self._waiting, gap_sec=gap_sec, out_sec=out_sec)
        return pairs.last_verdict() if told is None else told

    def loses_after_a_pause(self, messages: Iterator[VariedMessage]) -> bool:
        """Whether the first message after a pause is lost each time."""
        for number in range(PAUSES):
            if number >= FEWEST_LOST and self._is_over(LAST_SEC):
                break
            self._watcher.spin_for(PAUSE_SEC)
            if self._send(next(messages)):
                return False
        return True

    def _is_over(self, most_sec: float) -> bool:
        return self._watch.wall_sec() >= most_sec

    def _send(self, sent: VariedMessage) -> bool:
        """Publish a message; return whether it came out in time."""
        self._waiting.append(sent)
        self._let_in(sent)
        timeout_sec, watch = ON_TIME_SEC, Stopwatch()
        if self._slowest_sec:
            timeout_sec = max(LEAST_SEC, TIMEOUT_FACTOR * self._slowest_sec)
        if is_out := self._wait_for(sent, free_sec=min(timeout_sec, ON_TIME_SEC)):
            self._slowest_sec = max(self._slowest_sec, watch.wall_sec())
        return is_out

    def _comes_out_later(self, sent: VariedMessage, watch: Stopwatch, others: int) -> bool:
        """Wait for a message; send it again while messages of others may have pushed it out."""

        def is_overtaken() -> bool:
            return self._pushed_out.may_be(len(self._others) - others, watch)

        for again in range(MOST_AGAIN + 1):
            if again:
                others, watch = len(self._others), Stopwatch()
                self._let_in(sent)
            if self._wait_for(sent, free_sec=ON_TIME_SEC, unless=is_overtaken):
                self._copies[-1] -= again
                return True
            if not self._pushed_out.excuse(is_overtaken(), sent.kind):
                return False
        self._pushed_out.take_back(MOST_AGAIN + 1)  # lost each time: that is no coincidence
        return False

    def _wait_for(
        self, sent: VariedMessage, *, free_sec: float, unless: Callable[[], bool] = lambda: False
    ) -> bool:
        """Wait up to `free_sec` of free time for a message; return whether it came out."""

        def is_out() -> bool:
            self._take()
            return not any(each is sent for each in self._waiting)

        is_over = or_sleeps(lambda: is_out() or unless(), free_sec, self._recorder.publishers)
        self._watcher.spin_until_free(is_over, free_sec=free_sec)
        return is_out()

    def _let_in(self, sent: VariedMessage) -> None:
        self._own.add(self._what(sent.message))
        self._publish(sent.message)

    def _take(self) -> None:
        """Sort received messages: one that is waited for, a copy, or another publisher's."""
        received = self._recorder.received[self._seen :]
        self._seen += len(received)
        for message, sent_ns in received:
            what = self._what(message)
            for place, sent in enumerate(self._waiting):
                if what == self._what(sent.message):
                    del self._waiting[place]
                    self._out.append((what, sent_ns))
                    self._copies.append(1)
                    break
            else:
                self._count(what, sent_ns)

    def _count(self, what: Hashable, sent_ns: int) -> None:
        for place in reversed(range(max(0, len(self._out) - RECENT), len(self._out))):
            if what == self._out[place][0]:
                self._copies[place] += 1
                return
        if self._out or what != self._earlier:
            self._others.append((what, sent_ns))
