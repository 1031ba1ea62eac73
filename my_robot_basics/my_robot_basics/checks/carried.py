"""What becomes of messages that go through a node one at a time: each comes out at once, once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from my_robot_basics.checks.ears import Ears
from my_robot_basics.checks.watcher import Watcher

ON_TIME_SEC = 1.0
"""How long a message may take. Who passes it on by a timer is in time, too."""
QUIET_SEC = 0.1
"""How long to listen for a second copy."""
MOST_LATE = 2
"""So many tell enough: each is waited for."""


@dataclass(frozen=True)
class Carried:
    """How often each message came out, and how many did not before the next one was sent."""

    counts: tuple[int, ...]
    late: int

    def is_whole(self) -> bool:
        """Whether each came out in time, and once."""
        return not self.late and set(self.counts) == {1}

    def fault(self) -> tuple[str, str]:
        """What was seen, and what to try."""
        lost = self.counts.count(0)
        if lost > 1 or (lost and self.late == lost):
            return 'messages that are not republished', (
                'publish in every call of the callback: some messages are left out'
            )
        if self.late:
            return 'a message that is republished only when the next one arrives', (
                'publish the message that your callback is given, not the one before'
            )
        return f'a message that is republished {max(self.counts)} times', (
            'subscribe once, and publish once in each call of the callback'
        )


def carry(
    watcher: Watcher,
    ears: Ears,
    messages: Sequence[Any],
    *,
    publish: Callable[[Any], None],
    is_same: Callable[[Any, Any], bool],
) -> Carried:
    """Publish messages that all differ, each once the one before has come out or is late."""
    sent, late = [], 0
    for message in messages:
        if late >= MOST_LATE:
            break
        publish(message)
        sent.append(message)
        late += not watcher.spin_until_free(
            lambda: any(is_same(heard, sent[-1]) for heard in ears.messages()),
            free_sec=ON_TIME_SEC,
        )
    watcher.spin_for(QUIET_SEC)
    heard = ears.messages()
    return Carried(
        counts=tuple(sum(is_same(each, message) for each in heard) for message in sent),
        late=late,
    )
