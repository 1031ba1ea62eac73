"""Which lost messages those of other publishers may have pushed out of the node's queue."""

from dataclasses import dataclass, field

from my_robot_basics.checks.relays.enough import fewest_in_a_row
from my_robot_basics.feedback.hidden import is_in_test_room
from my_robot_basics.session.pressure import Stopwatch

FLOOD = 50
"""If others publish this many messages while the check waits for one, a queue overflows, and the
loss is not the node's fault."""
FEW = 3
"""On a busy machine, one message can push another out of a queue of depth 1. If this many that
were published later have come out, the other will not come any more."""
MOST_AGAIN = 3
"""How often a message is sent again that others may have pushed out."""
MOST, MOST_GRADED = 20, 5
"""At most MOST losses are excused; more are no coincidence. In the test's room, where an answer
seldom runs beside the lesson's arm, more than MOST_GRADED are in doubt: an answer can publish such
messages itself, and keep the processors busy itself."""
MORE_FOR_EACH = 10
"""In the test's room, so many more messages in a row have to come out for each excused loss: a
node that leaves out every tenth message never gets there."""


@dataclass
class PushedOut:
    """Decides which losses are excused, and counts them."""

    others_publish: bool
    """Whether nodes other than the check and the student's publish on the source topic."""
    kinds: list[str] = field(default_factory=list)
    """The kind of each message whose loss was excused."""
    is_doubtful: bool = False
    """Whether a loss that may be of this kind was one too many, in the test's room."""

    def may_be(self, overtaking: int, watch: Stopwatch) -> bool:
        """Whether a message may be lost because so many of others came out instead.

        If these are only FEW, this needs a busy machine: an idle node takes each message before
        the next one is there. `watch`: the time since the message was sent.
        """
        if not self.others_publish or overtaking < FEW:
            return False
        return overtaking >= FLOOD or watch.is_busy()

    def excuse(self, may_be: bool, kind: str) -> bool:
        """Excuse the loss of a message if it may be of this kind and there were not too many."""
        is_graded = is_in_test_room()
        is_excused = may_be and len(self.kinds) < (MOST_GRADED if is_graded else MOST)
        self.is_doubtful = self.is_doubtful or (is_graded and may_be and not is_excused)
        self.kinds += [kind] * is_excused
        return is_excused

    def take_back(self, number: int) -> None:
        """Excuse the latest `number` losses no more: they count as messages that are lost."""
        del self.kinds[-number:]

    def fewest_in_a_row(self, row: Stopwatch) -> int:
        """How many messages in a row are enough; `row`: the time since the row began."""
        more = MORE_FOR_EACH * len(self.kinds) if is_in_test_room() else 0
        return fewest_in_a_row(row) + more

    def doubts(self, is_told: bool) -> bool:
        """Whether the losses are in doubt; `is_told`: the other messages are enough for a verdict.

        Outside of the test's room, where nobody takes a second look, they are not.
        """
        return self.is_doubtful or (is_in_test_room() and bool(self.kinds) and not is_told)
