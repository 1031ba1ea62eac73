"""The lock of a gradebook: one process at a time writes into it, also `nbgrader autograde`."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from grader.common.logs import print_at_once

IGNORED = 'COLCON_IGNORE'
"""In a workspace of the instructor's that has the course in it, colcon would run the setup.py of
each package that was handed in, whichever package it builds: if package.xml names none, it asks
setup.py for the name."""


@contextmanager
def gradebook_lock(gradebook: Path, say: Callable[[str], None] = print_at_once) -> Iterator[None]:
    """Hold the lock of a gradebook for the block; wait for it first, and say so.

    The process that holds it may take it again. It is released when the outermost block or the
    process ends.
    """
    gradebook = gradebook.resolve()
    gradebook.mkdir(parents=True, exist_ok=True)
    if not (gradebook / IGNORED).exists():
        (gradebook / IGNORED).touch()
    path = gradebook / '.lock'
    lock = FileLock(path, is_singleton=True, thread_local=False, fallback_to_soft=False)
    try:
        lock.acquire(timeout=0)
    except Timeout:
        say(f'waiting: process {_holder(path)} is grading into {gradebook}')
        lock.acquire(poll_interval=0.1)
    try:
        path.write_text(str(os.getpid()), encoding='ascii')
        yield
    finally:
        lock.release()


def _holder(path: Path) -> str:
    return path.read_text(encoding='ascii', errors='replace')[:20] or 'unknown'
