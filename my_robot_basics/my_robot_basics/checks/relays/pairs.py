"""Pairs of messages in quick succession: how many show that a node keeps only the latest one."""

from dataclasses import dataclass, field

from my_robot_basics.session.pressure import Stopwatch

GAP_SEC = 0.01
"""The time between the two messages of a pair. A node that keeps only the latest message until its
timer fires republishes one of them only."""
MOST_GAP_SEC, MOST_APART = 0.015, 20
"""A pair proves nothing if a busy machine sent its messages more than MOST_GAP_SEC apart. The
first MOST_APART such pairs are ignored; later ones count."""
MOST_OUT_SEC = 0.1
"""A pair proves nothing, either, if its messages come out further apart than this: a slow timer
may have fired between them."""
WHOLE, MOST_SPLIT = 2, 6
"""A node is right if WHOLE pairs come out whole before MOST_SPLIT are split: a right node with a
queue of depth 1 may lose a message. It loses many on a busy machine: there, each whole pair
outweighs MOST_SPLIT split ones."""


@dataclass
class Pairs:
    """The results of the pairs so far."""

    whole: int = 0
    split: int = 0
    apart: int = 0
    watch: Stopwatch = field(default_factory=Stopwatch)

    def count(self, *, is_whole: bool, gap_sec: float, out_sec: float = 0.0) -> None:
        """Count one more pair.

        `gap_sec` is the time between sending its messages, `out_sec` between receiving them.
        """
        is_apart = gap_sec > MOST_GAP_SEC or out_sec > MOST_OUT_SEC
        if not is_whole:
            self.split += 1
        elif is_apart and self.apart < MOST_APART:
            self.apart += 1
        else:
            self.whole += 1

    def verdict(self) -> bool | None:
        """Whether mostly only one message of a pair comes out; None if more pairs are needed."""
        if self.whole >= WHOLE + self.split // MOST_SPLIT:
            return False
        most_split = MOST_SPLIT * (WHOLE + self.whole if self.watch.is_busy() else 1)
        return True if self.split >= most_split else None

    def last_verdict(self) -> bool:
        """The same if there is no time for more pairs."""
        return self.split >= MOST_SPLIT and self.whole < WHOLE
