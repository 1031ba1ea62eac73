"""Say no more of what was refused and is gone from the inbound folder: somebody saw to it."""

import os
import time

from grader.common.text import printable
from grader.serving.desk import Desk
from grader.serving.inbound import key_of

SETTLED_NS = 5_000_000_000
"""A folder that has changed so lately may change again without another time: some file systems
count in seconds."""


class Gone:
    """Looks for such entries whenever something was put into the folder, or taken away."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._changed_ns = -1

    def forget(self) -> bool:
        """Take them out of the queue; return whether there were any.

        Should one come back, it is looked into again: a network's file system may show nothing for
        a moment. One of which some was taken in is not, unless it has changed: what it holds would
        be handed in twice. Raises OSError where the folder is gone.
        """
        desk = self._desk
        changed_ns = os.stat(desk.inbound).st_mtime_ns
        if changed_ns == self._changed_ns:
            return False
        is_settled = abs(time.time_ns() - changed_ns) > SETTLED_NS
        self._changed_ns = changed_ns if is_settled else -1
        there = {key_of(name) for name in os.listdir(desk.inbound)}
        refused = desk.queue.refused_entries()
        for entry in sorted(refused - there):
            if desk.queue.forget(entry):
                desk.seen.pop(entry, None)
            desk.say(printable(f'gone, so it is listed no more: {entry}'))
        return bool(refused - there)
