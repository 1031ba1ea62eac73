"""Find new entries in a folder into which others put files, when they are complete."""

import contextlib
import hashlib
import os
import stat
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path

from grader.collect.archive_entries import MAX_PARTS
from grader.common.dates import utc_of
from grader.common.files import first_names
from grader.common.text import storable
from grader.notebook.submission import SECRET
from grader.serving.rounds import Rounds
from grader.serving.unexpected_errors import log_unexpected_error

QUIET_SEC = 1.0
"""An entry that has not changed for this long counts as complete."""
MOST_FILES = 5_000
"""At most this many files of one entry are checked, as many as are ever taken."""
_SUBMITTED = 0o777
"""The permissions that `nbgrader submit` sets on a folder as its last step."""
_FLAGS = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC


@dataclass(frozen=True)
class Entry:
    """A file or a folder in the inbound folder, whatever is in it."""

    name: str
    fingerprint: str
    """Changes when anything in the entry changes."""
    changed: datetime
    """The time of its last change (ctime), in UTC: its owner can't choose it."""
    is_whole: bool
    owner: str = ''
    """The owner it may belong to: owners take turns, so one with many entries delays no other."""
    problem: str = ''
    """Why it can't be read, or ''."""

    @property
    def key(self) -> str:
        """Return its name as the database stores it: unique for each name."""
        return key_of(self.name)


def key_of(name: str) -> str:
    """Return a storable form of a name that may not be UTF-8."""
    return storable(name.replace('\\', r'\\'))


def new_entries(
    folder: Path, seen: Mapping[str, str], rounds: Rounds | None = None
) -> Iterator[Entry]:
    """Yield complete entries whose fingerprint is not in `seen`; oldest first.

    If there are many, only some of them, with owners taking turns: see `rounds`. Raises OSError if
    the folder itself can't be read; an error with an entry is its `problem`.
    """
    with os.scandir(folder) as listed:
        names = sorted(each.name for each in listed if not each.name.startswith('.'))
    trusted = {0, os.geteuid(), os.stat(folder).st_uid}
    found, rounds = [], rounds or Rounds()
    for name in rounds.entries_in_turn(_entries_to_check(folder, names, seen, trusted)):
        before = seen.get(key_of(name))
        try:
            found.append(_check_entry(folder, name, before, trusted, rounds))
        except (FileNotFoundError, NotADirectoryError):
            continue  # removed meanwhile: what is left of it is checked in the next round
        except Exception as error:
            found.append(_with_problem(folder, name, before, error))
    yield from sorted(
        (each for each in found if each and each.is_whole),
        key=lambda each: (each.changed, each.name),
    )


def _entries_to_check(
    folder: Path, names: Collection[str], seen: Mapping[str, str], trusted: Collection[int]
) -> Iterator[tuple[str, str]]:
    """Yield the names of entries that may be new, with their possible owners."""
    for name in names:
        try:
            status = os.lstat(folder / name)
        except OSError:
            yield name, _owner_from_name(name)  # `_check_entry` will find out why
            continue
        before = seen.get(key_of(name))
        # nbgrader makes a new folder for each submission, and does not change it afterwards
        if before is None or '+' not in name or not before.startswith(f'{_place(status)} '):
            yield name, _owner(name, status, trusted)


def _check_entry(
    folder: Path, name: str, seen: str | None, trusted: Collection[int], rounds: Rounds
) -> Entry | None:
    """Return an entry; None if it has not changed since `seen`. Raises OSError if it is gone."""
    status = os.lstat(folder / name)
    digest, newest, names = hashlib.sha256(), status.st_ctime, set()
    for path, each in _tree(folder, name, status):
        rounds.count_files(1)
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
    """Return an entry that can't be read; None if the same problem was seen before."""
    changed, now = 0.0, time.time()
    with contextlib.suppress(OSError):
        changed = os.lstat(folder / name).st_ctime
    fingerprint = storable(f'{type(error).__name__} {error} {changed}')
    if fingerprint == seen:
        return None
    if isinstance(error, PermissionError):
        problem = 'this user may not read it: check its permissions'
    elif isinstance(error, OSError):
        problem = f'it cannot be read: {error.strerror}'
    else:
        problem = f'it cannot be read, because {log_unexpected_error(name, error)}'
    when = (utc_of(changed) if 0 < changed <= now else None) or datetime.now(UTC)
    is_whole = changed <= now - QUIET_SEC
    return Entry(name, fingerprint, when, is_whole, owner=_owner_from_name(name), problem=problem)


def _place(status: os.stat_result) -> str:
    return f'{status.st_dev}:{status.st_ino}:{status.st_uid}'


def _owner(name: str, status: os.stat_result, trusted: Collection[int]) -> str:
    return _owner_from_name(name) if status.st_uid in trusted else f'user {status.st_uid}'


def _owner_from_name(name: str) -> str:
    """Return the owner that an entry's name suggests, whatever form it has."""
    return name.partition('+' if '+' in name else '_')[0]


def _tree(folder: Path, name: str, status: os.stat_result) -> Iterator[tuple[str, os.stat_result]]:
    """Yield the paths in an entry with their status; links are not followed."""
    yield '', status
    if not stat.S_ISDIR(status.st_mode):
        return
    descriptor = os.open(folder / name, _FLAGS)
    try:
        yield from islice(_inside(descriptor, '.'), MOST_FILES)
    finally:
        os.close(descriptor)


def _inside(descriptor: int, path: str) -> Iterator[tuple[str, os.stat_result]]:
    names = first_names(descriptor, MOST_FILES)
    found = [(name, os.lstat(name, dir_fd=descriptor)) for name in names]
    yield from ((f'{path}/{name}', status) for name, status in found)
    if path.count('/') >= MAX_PARTS - 1:  # what is deeper is never taken
        return
    for name, status in found:
        if not stat.S_ISDIR(status.st_mode):
            continue
        try:
            inner = os.open(name, _FLAGS, dir_fd=descriptor)
        except PermissionError:
            continue  # it is reported when the entry is read
        try:
            yield from _inside(inner, f'{path}/{name}')
        finally:
            os.close(inner)
