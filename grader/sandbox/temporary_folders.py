"""What this process has on the machine beside processes, and what graders that were killed left.

That is a temporary folder, and the cgroups that are written down in it.
"""

import atexit
import contextlib
import fcntl
import os
import shutil
import tempfile
import time
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from grader.sandbox.cgroups import remove_cgroup

PREFIX = 'mrb-rooms-'
MAX_PARENT = 50
"""A Unix socket's path holds 107 characters at most."""
_CGROUPS = 'cgroups-'
_END_SEC = 5.0
"""What killed processes may take to leave their cgroup."""


def own_folder() -> Path:
    """Return the temporary folder of this process: nobody else can enter it.

    It goes when the process ends. What a killed one left, the next one removes.
    """
    parent = tempfile.gettempdir()
    return _own_folder(Path('/tmp' if len(parent) > MAX_PARENT else parent), os.getpid())


def note_cgroups(name: str, folders: Iterable[Path]) -> Path:
    """Write down cgroups before they are made, so that they go even if this process is killed.

    Return the file: it is to be removed when they are gone.
    """
    note = own_folder() / f'{_CGROUPS}{name}'
    note.write_text('\n'.join(map(str, folders)), encoding='utf-8')
    return note


def sweep(parent: Path) -> list[Path]:
    """Remove and return the folders of this user in which nobody lives any more."""
    removed = []
    for folder in parent.glob(f'{PREFIX}*'):
        with contextlib.suppress(OSError), _opened(folder) as lock:  # a link; another's; gone
            if os.fstat(lock).st_uid == os.geteuid():
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if _remove_cgroups(folder):  # else the next one tries again
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
        _remove_cgroups(folder)
        shutil.rmtree(folder, ignore_errors=True)


def _remove_cgroups(folder: Path) -> bool:
    """Remove the cgroups that are written down in a folder; return whether they are gone."""
    notes = [note.read_text(encoding='utf-8') for note in folder.glob(f'{_CGROUPS}*')]
    left = [Path(line) for note in notes for line in note.splitlines()]
    deadline = time.monotonic() + _END_SEC
    while left := [path for path in left if not remove_cgroup(path)]:
        if time.monotonic() > deadline:
            return False
        time.sleep(0.01)
    return True


@contextlib.contextmanager
def _opened(folder: Path) -> Iterator[int]:
    """Open a folder that is no link."""
    lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        yield lock
    finally:
        os.close(lock)
