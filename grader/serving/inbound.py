"""Look at a folder into which others put files: what is new there, and is written to its end."""

import hashlib
import os
import stat
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from grader.notebook.submission import SECRET

QUIET_SEC = 1.0
"""What nobody has changed for so long is taken to be whole."""
MOST_FILES = 5_000
"""So many of one entry are looked at, as many as are ever taken."""
_SUBMITTED = 0o777
"""What `nbgrader submit` makes of a folder at its very end."""
_FLAGS = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


@dataclass(frozen=True)
class Entry:
    """A file or a folder that lies in the inbound folder, whatever is in it."""

    name: str
    fingerprint: str
    """Another one once anything in it has changed."""
    changed: datetime
    """When Linux last saw it change, in UTC: nobody can set that."""
    is_whole: bool


def new_entries(folder: Path, seen: Mapping[str, str]) -> Iterator[Entry]:
    """Yield what is not `seen`, by its fingerprint, and was written to its end; oldest first.

    Raises OSError where the folder itself can't be read.
    """
    with os.scandir(folder) as listed:
        names = sorted(each.name for each in listed if not each.name.startswith('.'))
    found = [each for name in names if (each := _look(folder, name, seen.get(name)))]
    yield from sorted(
        (each for each in found if each.is_whole), key=lambda each: (each.changed, each.name)
    )


def _look(folder: Path, name: str, seen: str | None) -> Entry | None:
    """Return an entry; None where it is as it was seen, or is gone."""
    try:
        status = os.lstat(folder / name)
        # nbgrader makes another folder for each submission: what one holds is handed in
        if seen is not None and '+' in name and seen.startswith(f'{_place(status)} '):
            return None
        digest, newest, names = hashlib.sha256(), status.st_ctime, set()
        for path, each in _tree(folder, name, status):
            newest = max(newest, each.st_ctime)
            names.add(path.rpartition('/')[2])
            digest.update(f'{path}\0{each.st_ino} {each.st_size} {each.st_ctime_ns}\0'.encode())
    except OSError:
        return None  # gone meanwhile: what is left of it is looked at again
    fingerprint = f'{_place(status)} {digest.hexdigest()}'
    if fingerprint == seen:
        return None
    now = time.time()
    is_submitted = SECRET in names and stat.S_IMODE(status.st_mode) & 0o777 == _SUBMITTED
    return Entry(
        name,
        fingerprint,
        datetime.fromtimestamp(min(newest, now), UTC),
        is_whole=is_submitted or newest <= now - QUIET_SEC,
    )


def _place(status: os.stat_result) -> str:
    return f'{status.st_dev}:{status.st_ino}:{status.st_uid}'


def _tree(folder: Path, name: str, status: os.stat_result) -> Iterator[tuple[str, os.stat_result]]:
    """Yield what lies in an entry, by its path there; no link is followed."""
    yield '', status
    if not stat.S_ISDIR(status.st_mode):
        return
    left = MOST_FILES
    descriptor = os.open(folder / name, _FLAGS)
    try:
        for path, folders, files, inside in os.fwalk('.', dir_fd=descriptor):
            for each in sorted([*folders, *files]):
                left -= 1
                if left < 0:
                    return
                yield f'{path}/{each}', os.lstat(each, dir_fd=inside)
    finally:
        os.close(descriptor)
