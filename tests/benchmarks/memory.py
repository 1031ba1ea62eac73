"""How much memory a command uses, with all processes that it starts.

Fork servers leave the process tree of the command, but stay in the session that they start.
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
"""Interval at which memory is measured."""


class Family:
    """A process, its descendants, and those in the sessions of its fork servers."""

    def __init__(self, pid: int) -> None:
        """Take a process that has not started any other yet."""
        self._root = pid
        self._sessions: set[int] = set()

    def pss_bytes(self) -> int:
        """Return the memory that they use now (PSS, so shared pages count once)."""
        return sum(map(_pss, self.members()))

    def members(self) -> set[psutil.Process]:
        """Return all that are alive; call it often, to see each fork server when it starts."""
        tree = _with_children(self._root)
        for process in tree:
            with suppress(psutil.Error, ProcessLookupError):
                if any('forkserver' in word for word in process.cmdline()):
                    self._sessions.add(os.getsid(process.pid))
        servers = [pid for pid in psutil.pids() if _session(pid) in self._sessions]
        return tree.union(chain.from_iterable(map(_with_children, servers)))


@contextmanager
def peak_of(pid: int) -> Iterator[list[int]]:
    """Yield a list with one element; at the end it is the peak in bytes."""
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
        return 0  # it has ended
    return 1024 * int(re.search(r'^Pss:\s+(\d+) kB', rollup, re.MULTILINE)[1])
