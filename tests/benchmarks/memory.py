"""How much memory a command takes, with all that it has begun.

What forks kernels leaves the tree of processes below the command, and keeps the session that it
began.
"""

import os
import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import chain
from pathlib import Path

import psutil

LOOK_SEC = 0.5
"""So often memory is looked at."""


class Family:
    """A process, what it has begun, and what these have."""

    def __init__(self, pid: int) -> None:
        """Begin with a process, before it has begun any other."""
        self._root = pid
        self._sessions: set[int] = set()

    def pss_bytes(self) -> int:
        """Return what they take now: what shared pages hold is counted once (PSS)."""
        return sum(map(_pss, self.members()))

    def members(self) -> set[psutil.Process]:
        """Return all of them that live; to be called often enough to see each server begin."""
        tree = _with_children(self._root)
        for process in tree:
            with suppress(psutil.Error, ProcessLookupError):
                if any('forkserver' in word for word in process.cmdline()):
                    self._sessions.add(os.getsid(process.pid))
        servers = [pid for pid in psutil.pids() if _session(pid) in self._sessions]
        return tree.union(chain.from_iterable(map(_with_children, servers)))


@contextmanager
def peak_of(pid: int) -> Iterator[list[int]]:
    """Give a list that has one element in the end: the most bytes that were seen."""
    over, family, peak = threading.Event(), Family(pid), [0]

    def look() -> None:
        while not over.wait(LOOK_SEC):
            peak[0] = max(peak[0], family.pss_bytes())

    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    try:
        yield peak
    finally:
        over.set()
        thread.join()


def _with_children(pid: int) -> set[psutil.Process]:
    try:
        process = psutil.Process(pid)
        return {process, *process.children(recursive=True)}
    except psutil.NoSuchProcess:
        return set()


def _session(pid: int) -> int | None:
    try:
        return os.getsid(pid)
    except ProcessLookupError:
        return None


def _pss(process: psutil.Process) -> int:
    try:
        rollup = Path(f'/proc/{process.pid}/smaps_rollup').read_text(encoding='ascii')
    except (FileNotFoundError, ProcessLookupError):
        return 0  # it has ended since
    return 1024 * int(re.search(r'^Pss:\s+(\d+) kB', rollup, re.MULTILINE)[1])
