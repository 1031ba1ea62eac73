"""Stop listing refused entries that were removed from the inbound folder by a person."""

import os
import time

from grader.common.text import printable
from grader.serving.inbound import key_of
from grader.serving.state import ServingState

SETTLED_NS = 5_000_000_000
"""A folder that changed less than this ago may change again with the same time: some file
systems store times in whole seconds."""


class RemovedEntries:
    """Looks for removed entries whenever the inbound folder has changed."""

    def __init__(self, serving: ServingState) -> None:
        self._serving = serving
        self._changed_ns = -1

    def forget(self) -> bool:
        """Remove them from the queue; return whether there were any.

        If one comes back, it is read again: a network file system may show nothing for a moment.
        But an entry from which submissions were taken is not, unless it has changed: they would be
        handed in twice. Raises OSError if the folder is gone.
        """
        serving = self._serving
        changed_ns = os.stat(serving.inbound).st_mtime_ns
        if changed_ns == self._changed_ns:
            return False
        is_settled = abs(time.time_ns() - changed_ns) > SETTLED_NS
        self._changed_ns = changed_ns if is_settled else -1
        there = {key_of(name) for name in os.listdir(serving.inbound)}
        refused = serving.queue.refused_entries()
        for entry in sorted(refused - there):
            if serving.queue.forget(entry):
                serving.seen.pop(entry, None)
            serving.say(printable(f'no longer there, so no longer listed: {entry}'))
        return bool(refused - there)
