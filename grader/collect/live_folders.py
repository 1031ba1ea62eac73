"""Read a folder in which other users may write meanwhile: each file is opened once, and copied.

Everything is checked on the open file: a moment later, its name may refer to another file. The
result has the file's owner and its change time (ctime), which its owner can't choose.
"""

import os
import pwd
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path

from grader.collect.archive_entries import ARCHIVE, MAX_PARTS
from grader.collect.archives import MAX_FILE_BYTES
from grader.collect.incoming import Incoming
from grader.collect.unpack_limits import OF_USER, ONE, UnpackLimits
from grader.common.dates import utc_of
from grader.common.errors import MACHINE_FULL
from grader.common.files import first_names

LINK = 'a link: only files are taken'
DEVICE = 'a device or the like: only files are taken'
CHANGED = 'it was changed while it was read: collect again'
MAX_ARCHIVE_BYTES = 500_000_000
"""A whole class's archive is smaller, and is in a folder that only the instructor writes to."""
_FLAGS = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC
_CHUNK = 1 << 20


@dataclass(frozen=True)
class _ParentFolder:
    """What is known about the folder that contains an entry."""

    descriptor: int
    parts: tuple[str, ...]
    trusted: frozenset[int]
    """Users whose files a person or a platform named: ours, root, the owner of the outermost
    folder."""
    is_shared: bool
    """Whether users besides its owner may write there."""
    uid: int | None = None
    """The user who must own everything in it, below an entry of an untrusted user; else None."""
    changed: float = 0.0
    """The latest ctime of it and the folders around it that belong to an untrusted user."""


@dataclass(frozen=True)
class LiveFolder:
    """Reads a folder: where copies go, how much may be read, and which files are wanted."""

    aside: Path
    left: UnpackLimits
    wanted: Callable[[tuple[str, ...]], bool]
    of_users: dict[int, UnpackLimits] = field(default_factory=dict)

    def read(self, folder: Path, above: tuple[str, ...]) -> Iterator[Incoming]:
        """Yield copies of the files in a folder; only `folder` itself may be a link."""
        with _closing(os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)) as descriptor:
            yield from self._entries(_outermost(descriptor, above))

    def read_entry(
        self, folder: Path, name: str, *, trusted: Iterable[int] = ()
    ) -> Iterator[Incoming]:
        """Yield what one name in a folder refers to; `trusted` users may have chosen the name."""
        with _closing(os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)) as descriptor:
            yield from self._entry(_outermost(descriptor, (), trusted), name)

    def _entries(self, within: _ParentFolder) -> Iterator[Incoming]:
        # one more than may be read: it gets the reason
        for name in first_names(within.descriptor, max(0, self.left.files + 1)):
            yield from self._entry(within, name)

    def _entry(self, within: _ParentFolder, name: str) -> Iterator[Incoming]:
        parts = (*within.parts, name)
        self.left.files -= 1
        if self.left.files < 0:
            if self.left.files == -1:
                yield Incoming(parts, problem='too many files: this one and more were not read')
            return
        if (bare := Incoming(parts)).is_litter:
            yield bare
            return
        try:
            # opening a device can have effects: check before, and again on the open file
            if problem := _problem_of_kind(os.lstat(name, dir_fd=within.descriptor).st_mode):
                yield Incoming(parts, problem=problem)
                return
            with _closing(os.open(name, _FLAGS, dir_fd=within.descriptor)) as descriptor:
                yield from self._opened(within, parts, descriptor)
        except PermissionError:
            yield Incoming(parts, problem='this user may not read it: check its permissions')
        except OSError as error:  # it was removed or replaced by a link, or the disk is damaged
            if error.errno in MACHINE_FULL:
                raise
            yield Incoming(parts, problem=f'it cannot be read: {error.strerror}')

    def _opened(
        self, within: _ParentFolder, parts: tuple[str, ...], descriptor: int
    ) -> Iterator[Incoming]:
        status = os.fstat(descriptor)
        foreign = status.st_uid not in within.trusted
        changed = max(within.changed, status.st_ctime) if foreign else 0.0
        problem = _problem_of_kind(status.st_mode)
        if within.uid not in (None, status.st_uid):
            problem = 'it is not of the user whose folder it is in'
        elif foreign and not _login(status.st_uid):
            problem = f'it is of user {status.st_uid}, who has no name on this machine'
        elif within.is_shared and stat.S_ISREG(status.st_mode) and status.st_nlink > 1:
            problem = LINK
        if problem:
            yield Incoming(parts, problem=problem)
        elif stat.S_ISREG(status.st_mode):
            file, problem = None, ''
            if self.wanted(parts):
                file, problem = self._copy(descriptor, status, bool(ARCHIVE.search(parts[-1])))
            yield Incoming(
                parts,
                file,
                utc_of(status.st_mtime),
                problem,
                login=_login(status.st_uid) if foreign else '',
                changed=(utc_of(changed) or datetime.now(UTC)) if foreign else None,
            )
        elif len(parts) > MAX_PARTS:
            yield Incoming(parts, problem=f'it is more than {MAX_PARTS} folders deep')
        else:
            inner = _ParentFolder(
                descriptor,
                parts,
                within.trusted,
                within.is_shared or _is_shared(status),
                status.st_uid if foreign else None,
                changed,
            )
            if foreign and within.uid is None:
                whole = self.of_users.setdefault(status.st_uid, UnpackLimits(**OF_USER))
                with whole.lend(**ONE) as left:
                    yield from replace(self, left=left)._entries(inner)
            else:
                yield from self._entries(inner)

    def _copy(
        self, descriptor: int, before: os.stat_result, is_archive: bool
    ) -> tuple[Path | None, str]:
        allowed = MAX_ARCHIVE_BYTES if is_archive else MAX_FILE_BYTES
        # not even read: a sparse file takes no space on its owner's disk
        if problem := self.left.claim(before.st_size, most=allowed, is_archive=is_archive):
            return None, problem
        copied = 0
        with tempfile.NamedTemporaryFile(dir=self.aside, delete=False) as target:
            while copied <= before.st_size and (chunk := os.read(descriptor, _CHUNK)):
                target.write(chunk)
                copied += len(chunk)
        if _written(os.fstat(descriptor)) != _written(before) or copied != before.st_size:
            problem = CHANGED
        if problem:
            Path(target.name).unlink()
        return (None if problem else Path(target.name)), problem


def _outermost(
    descriptor: int, above: tuple[str, ...], trusted: Iterable[int] = ()
) -> _ParentFolder:
    status = os.fstat(descriptor)
    users = frozenset({0, os.geteuid(), status.st_uid, *trusted})
    return _ParentFolder(descriptor, above, users, _is_shared(status))


def _is_shared(status: os.stat_result) -> bool:
    return bool(status.st_mode & (stat.S_IWGRP | stat.S_IWOTH))


def _written(status: os.stat_result) -> tuple[int, int, int]:
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns


def _problem_of_kind(mode: int) -> str:
    if stat.S_ISLNK(mode):
        return LINK
    return '' if stat.S_ISREG(mode) or stat.S_ISDIR(mode) else DEVICE


def _login(uid: int) -> str:
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return ''


@contextmanager
def _closing(descriptor: int) -> Iterator[int]:
    try:
        yield descriptor
    finally:
        os.close(descriptor)
