"""Two messages in quick succession: how many such pairs tell that a node keeps only the latest."""

from dataclasses import dataclass, field

from my_robot_basics.session.pressure import Stopwatch

GAP_SEC = 0.01
"""Two messages so near to each other: a node that keeps only the latest for a timer loses one."""
MOST_GAP_SEC, MOST_APART = 0.015, 20
"""A busy machine lets more time pass between them: so many such pairs prove nothing. …"""
MOST_OUT_SEC = 0.1
"""… Nor do those that come out so far apart: a slow timer published between the two."""
WHOLE, MOST_SPLIT = 2, 6
"""So many pairs have to come out, before so many did not: a queue of depth 1 may lose one. On a
busy machine it loses many, and some come out: each that does is worth so many that do not."""


@dataclass
class Pairs:
    """What became of the pairs so far."""

    whole: int = 0
    split: int = 0
    apart: int = 0
    watch: Stopwatch = field(default_factory=Stopwatch)

    def count(self, *, is_whole: bool, gap_sec: float, out_sec: float = 0.0) -> None:
        """Count one more, with so much time between its two messages, in and out."""
        is_apart = gap_sec > MOST_GAP_SEC or out_sec > MOST_OUT_SEC
        if not is_whole:
            self.split += 1
        elif is_apart and self.apart < MOST_APART:
            self.apart += 1
        else:
            self.whole += 1

    def tell(self) -> bool | None:
        """Whether mostly one of two alone comes out; None where more pairs have to tell."""
        if self.whole >= WHOLE + self.split // MOST_SPLIT:
            return False
        most_split = MOST_SPLIT * (WHOLE + self.whole if self.watch.is_busy() else 1)
        return True if self.split >= most_split else None

    def tell_at_last(self) -> bool:
        """The same where there is no time for more."""
        return self.split >= MOST_SPLIT and self.whole < WHOLE
