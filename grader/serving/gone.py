"""Say no more of what was refused and is gone from the inbound folder: somebody saw to it."""

import os

from grader.common.text import printable
from grader.serving.desk import Desk
from grader.serving.inbound import key_of
from grader.serving.queue import REFUSED


class Gone:
    """Looks for such entries whenever something was put into the folder, or taken away."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._changed_ns = -1

    def forget(self) -> bool:
        """Take them out of the queue; return whether there were any.

        Should one come back, it is looked into again. Raises OSError where the folder is gone.
        """
        desk = self._desk
        changed_ns = os.stat(desk.inbound).st_mtime_ns
        if changed_ns == self._changed_ns:
            return False
        self._changed_ns = changed_ns
        there = {key_of(name) for name in os.listdir(desk.inbound)}
        refused = {each.entry for each in desk.queue.find(REFUSED) if not each.student_id}
        for entry in sorted(refused - there):
            desk.queue.forget(entry)
            desk.seen.pop(entry, None)
            desk.say(printable(f'gone, so it is listed no more: {entry}'))
        return bool(refused - there)
