"""Which lost messages those of other publishers may have pushed out of the node's queue."""

from dataclasses import dataclass

from my_robot_basics.session.pressure import Stopwatch

FLOOD = 50
"""If others publish this many messages while the check waits for one, a queue overflows, and the
loss is not the node's fault."""
FEW = 3
"""On a busy machine, one message can push another out of a queue of depth 1. If this many that
were published later have come out, the other will not come any more."""
MOST_AGAIN = 3
"""How often a message is sent again that others may have pushed out."""
MOST = 20
"""At most this many losses are excused; more are no coincidence."""


@dataclass
class PushedOut:
    """Decides which losses are excused, and counts them."""

    others_publish: bool
    """Whether nodes other than the check and the student's publish on the source topic."""
    number: int = 0

    def may_be_by_few(self, overtaking: int, watch: Stopwatch) -> bool:
        """Whether a message may be lost because so many of others came out instead.

        Only on a busy machine: an idle node takes each message before the next one is there.
        `watch`: the time since the message was sent.
        """
        return overtaking >= FEW and self.others_publish and watch.is_busy()

    def excuse(self, may_be: bool) -> bool:
        """Excuse one more loss if it may be of this kind and there were not too many."""
        is_excused = may_be and self.number < MOST
        self.number += is_excused
        return is_excused
