"""The temporary folder of this process, and those of graders that were killed."""

import atexit
import contextlib
import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

PREFIX = 'mrb-rooms-'
MAX_PARENT = 50
"""A Unix socket's path holds 107 characters at most."""


def own_folder() -> Path:
    """Return the temporary folder of this process: nobody else can enter it.

    It goes when the process ends. What a killed one left, the next one removes.
    """
    parent = tempfile.gettempdir()
    return _own_folder(Path('/tmp' if len(parent) > MAX_PARENT else parent), os.getpid())


def sweep(parent: Path) -> list[Path]:
    """Remove and return the folders of this user in which nobody lives any more."""
    removed = []
    for folder in parent.glob(f'{PREFIX}*'):
        with contextlib.suppress(OSError), _opened(folder) as lock:  # a link; another's; gone
            if os.fstat(lock).st_uid == os.geteuid():
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder)
                removed.append(folder)
    return removed


@cache
def _own_folder(parent: Path, process: int) -> Path:
    sweep(parent)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=parent))
        # what cleans /tmp now and then leaves a locked folder alone, too
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(lock, fcntl.LOCK_SH)
        if folder.exists():
            break
        os.close(lock)  # another one just took it for a leftover
    atexit.register(_remove, folder, process)
    return folder


def _remove(folder: Path, process: int) -> None:
    if os.getpid() == process:  # not a copy of it
        shutil.rmtree(folder, ignore_errors=True)


@contextlib.contextmanager
def _opened(folder: Path) -> Iterator[int]:
    """Open a folder that is no link."""
    lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        yield lock
    finally:
        os.close(lock)
