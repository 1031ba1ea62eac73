"""The temporary folder and the cgroups of this process, and those that killed graders left.

The folder has a note of each of the cgroups.
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
"""Length of the folder's path: the path of a Unix socket in it has at most 107 characters."""
_CGROUPS = 'cgroups-'
_END_SEC = 5.0
"""How long killed processes may take to leave their cgroup."""


def own_folder() -> Path:
    """Return the temporary folder of this process: other users can't enter it.

    It is removed when the process ends, or by the next grader if the process is killed.
    """
    parent = tempfile.gettempdir()
    return _own_folder(Path('/tmp' if len(parent) > MAX_PARENT else parent), os.getpid())


def note_cgroups(name: str, folders: Iterable[Path]) -> Path:
    """Write a note of cgroups before they are made: if this process is killed, they are removed.

    Return the file of the note; the caller removes it when the cgroups are gone.
    """
    note = own_folder() / f'{_CGROUPS}{name}'
    note.write_text('\n'.join(map(str, folders)), encoding='utf-8')
    return note


def remove_stale_folders(parent: Path) -> list[Path]:
    """Remove this user's folders whose process has ended; return them."""
    removed = []
    for folder in parent.glob(f'{PREFIX}*'):
        with contextlib.suppress(OSError), _opened(folder) as lock:  # a link; in use; removed
            if os.fstat(lock).st_uid == os.geteuid():
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if _remove_cgroups(folder):  # if not, the next grader tries again
                    shutil.rmtree(folder)
                    removed.append(folder)
    return removed


@cache
def _own_folder(parent: Path, process: int) -> Path:
    remove_stale_folders(parent)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=parent))
        # programs that clean /tmp from time to time do not remove a locked folder
        lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
        fcntl.flock(lock, fcntl.LOCK_SH)
        if folder.exists():
            break
        os.close(lock)  # another grader has just removed it as a leftover
    atexit.register(_remove, folder, process)
    return folder


def _remove(folder: Path, process: int) -> None:
    if os.getpid() == process:  # not in a process forked from it
        _remove_cgroups(folder)
        shutil.rmtree(folder, ignore_errors=True)


def _remove_cgroups(folder: Path) -> bool:
    """Remove the cgroups of a folder's notes; return whether they are gone."""
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
    """Open a folder, but not through a link."""
    lock = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        yield lock
    finally:
        os.close(lock)
