"""Look at a folder into which others put files: what is new there, and is written to its end."""

import contextlib
import hashlib
import os
import stat
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from grader.collect.archive_entries import MAX_PARTS
from grader.common.dates import utc_of
from grader.common.text import storable
from grader.notebook.submission import SECRET
from grader.serving.rounds import Rounds
from grader.serving.trouble import noted

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
    owner: str = ''
    """Whose it may be: owners take turns, so that one with many entries delays nobody."""
    problem: str = ''
    """Why it can't be looked at."""

    @property
    def key(self) -> str:
        """Return its name as the database keeps it: no two names have one."""
        return key_of(self.name)


def key_of(name: str) -> str:
    """Return what stands for a name that may be no UTF-8."""
    return storable(name.replace('\\', r'\\'))


def new_entries(
    folder: Path, seen: Mapping[str, str], rounds: Rounds | None = None
) -> Iterator[Entry]:
    """Yield what is not `seen`, by its fingerprint, and was written to its end; oldest first.

    If there is much, it is some of it, with owners taking turns: see `rounds`. Raises OSError
    where the folder itself can't be read; whatever goes wrong with an entry is its `problem`.
    """
    with os.scandir(folder) as listed:
        names = sorted(each.name for each in listed if not each.name.startswith('.'))
    trusted = {0, os.geteuid(), os.stat(folder).st_uid}
    found, rounds = [], rounds or Rounds()
    for name in rounds.of(_to_look_at(folder, names, seen, trusted)):
        before = seen.get(key_of(name))
        try:
            found.append(_look(folder, name, before, trusted, rounds))
        except (FileNotFoundError, NotADirectoryError):
            continue  # gone meanwhile: what is left of it is looked at again
        except Exception as error:
            found.append(_with_problem(folder, name, before, error))
    yield from sorted(
        (each for each in found if each and each.is_whole),
        key=lambda each: (each.changed, each.name),
    )


def _to_look_at(
    folder: Path, names: Collection[str], seen: Mapping[str, str], trusted: Collection[int]
) -> Iterator[tuple[str, str]]:
    """Yield the names of what may be new, and whose it may be."""
    for name in names:
        try:
            status = os.lstat(folder / name)
        except OSError:
            yield name, _named(name)  # to look at it tells why
            continue
        before = seen.get(key_of(name))
        # nbgrader makes another folder for each submission: what one holds is handed in
        if before is None or '+' not in name or not before.startswith(f'{_place(status)} '):
            yield name, _owner(name, status, trusted)


def _look(
    folder: Path, name: str, seen: str | None, trusted: Collection[int], rounds: Rounds
) -> Entry | None:
    """Return an entry; None where it is as it was seen. Raises OSError where it is gone."""
    status = os.lstat(folder / name)
    digest, newest, names = hashlib.sha256(), status.st_ctime, set()
    for path, each in _tree(folder, name, status):
        rounds.counted(1)
        newest = max(newest, each.st_ctime)
        names.add(path.rpartition('/')[2])
        digest.update(os.fsencode(path))
        digest.update(f'\0{each.st_ino} {each.st_size} {each.st_ctime_ns}\0'.encode())
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
        owner=_owner(name, status, trusted),
    )


def _with_problem(folder: Path, name: str, seen: str | None, error: Exception) -> Entry | None:
    """Return an entry that can't be looked at; None where that was seen."""
    changed, now = 0.0, time.time()
    with contextlib.suppress(OSError):
        changed = os.lstat(folder / name).st_ctime
    fingerprint = storable(f'{type(error).__name__} {error} {changed}')
    if fingerprint == seen:
        return None
    if isinstance(error, PermissionError):
        problem = 'it must not be read: see its permissions'
    elif isinstance(error, OSError):
        problem = f'it can not be looked at: {error.strerror}'
    else:
        problem = f'it can not be looked at, for {noted(name, error)}'
    when = (utc_of(changed) if 0 < changed <= now else None) or datetime.now(UTC)
    is_whole = changed <= now - QUIET_SEC
    return Entry(name, fingerprint, when, is_whole, owner=_named(name), problem=problem)


def _place(status: os.stat_result) -> str:
    return f'{status.st_dev}:{status.st_ino}:{status.st_uid}'


def _owner(name: str, status: os.stat_result, trusted: Collection[int]) -> str:
    return _named(name) if status.st_uid in trusted else f'user {status.st_uid}'


def _named(name: str) -> str:
    """Return whose an entry may be by its name, whatever form that has."""
    return name.partition('+' if '+' in name else '_')[0]


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
            if path.count('/') >= MAX_PARTS - 1:  # what lies deeper is not taken
                folders.clear()
    finally:
        os.close(descriptor)
