"""Folders with one submission each: write them atomically, compare them, keep earlier ones."""

import hashlib
import os
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import datetime
from functools import lru_cache
from pathlib import Path

from my_robot_basics.session import package_files

from grader.collect.archive_entries import MAX_PARTS
from grader.common.errors import TaskFailed
from grader.notebook.submission import LEFT_OUT, SECRET, TIMESTAMP

MAX_FILES, MAX_BYTES, MAX_DEPTH = 20_000, 2_000_000_000, MAX_PARTS
"""Far more than is ever collected for one student: it was put there by hand."""
MOST_REMEMBERED = 100_000
"""Digests of earlier submissions' files that are cached, in 0.04 GB at most."""


def contents(folder: Path, *, read_once: bool = False) -> dict[str, bytes]:
    """Return the digests of a submission's files, without the exchange's additional files.

    Links are not followed. With `read_once`, a file is not read again until its status (ctime)
    changes. Raises TaskFailed if there is more than a submission can have.
    """
    ours = {folder / name for name in (TIMESTAMP, SECRET, LEFT_OUT)}
    files: dict[str, Path] = {}
    size = 0
    for path in _files_in(folder):
        try:
            status = path.lstat()
        except FileNotFoundError:
            continue  # it is being replaced; it is read again before the result is stored
        if stat.S_ISREG(status.st_mode) and path not in ours:
            files[path.relative_to(folder).as_posix()] = path
            size += status.st_size
        if len(files) > MAX_FILES or size > MAX_BYTES:
            raise TaskFailed(
                f'{folder} holds more than {MAX_FILES:,} files or {MAX_BYTES / 1e9:g} GB: '
                'remove what is no part of the submission'
            )
    return digests(dict(sorted(files.items())), read_once=read_once)


def _files_in(folder: Path) -> Iterator[Path]:
    for above, folders, names in os.walk(folder):
        here = Path(above)
        if folders and len(here.relative_to(folder).parts) >= MAX_DEPTH:
            raise TaskFailed(
                f'{folder} holds more than {MAX_DEPTH} folders in each other: remove what is no '
                'part of the submission'
            )
        yield from (here / name for name in names)


def digests(files: Mapping[str, Path], *, read_once: bool = False) -> dict[str, bytes]:
    """Return digests to compare files by: several submissions of 200 MB would fill the memory."""
    digest = _digest_read_once if read_once else _digest
    return {name: digest(path) for name, path in files.items()}


def _digest(path: Path) -> bytes:
    with path.open('rb') as file:
        return hashlib.file_digest(file, 'sha256').digest()


def _digest_read_once(path: Path) -> bytes:
    status = path.lstat()
    state = status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns
    return _remembered_digest(path, *state)


@lru_cache(maxsize=MOST_REMEMBERED)
def _remembered_digest(path: Path, *_state: int) -> bytes:
    return _digest(path)


def contents_of_earlier(shelf: Path) -> list[dict[str, bytes]]:
    """Return the digests of each submission that is kept in `shelf`.

    Kept submissions do not change, so each file is read only once: `./course serve` took 44 s for
    a submission after 49 others of 19 MB each, on a slow disk, and the class had to wait.
    """
    return [contents(folder, read_once=True) for folder in shelf.glob('*/submitted')]


def timestamp(handed_in: datetime) -> str:
    """Return a time in UTC as nbgrader writes it."""
    return handed_in.strftime('%Y-%m-%d %H:%M:%S.%f UTC')


def writer(
    files: Mapping[str, Path],
    handed_in: datetime | None,
    *,
    secret: Path | None = None,
    left_out: Sequence[str] = (),
) -> Callable[[Path], None]:
    """Return a function that writes a submission into an empty folder, the time as nbgrader does.

    `files` are keyed by their paths there; `left_out` lists files that were not taken.
    """

    def write(folder: Path) -> None:
        for name, path in files.items():
            if '/' in name:
                package_files.write({name: path}, folder)
            else:
                shutil.copyfile(path, folder / name)
        if left_out:
            (folder / LEFT_OUT).write_text('\n'.join(left_out) + '\n', encoding='utf-8')
        if handed_in:
            (folder / TIMESTAMP).write_text(timestamp(handed_in), encoding='ascii')
        if secret:
            shutil.copyfile(secret, folder / SECRET)

    return write


def within(name: str, write: Callable[[Path], None]) -> Callable[[Path], None]:
    """Return a function that writes into a new subfolder of that name."""

    def write_within(folder: Path) -> None:
        (folder / name).mkdir()
        write(folder / name)

    return write_within


def put_numbered(write: Callable[[Path], None], shelf: Path) -> Path:
    """Put a folder beside the earlier ones, with the next number; return its path."""
    numbers = [int(path.name) for path in shelf.glob('*') if path.name.isdecimal()]
    place = shelf / str(max(numbers, default=0) + 1)
    put_atomically(write, place)
    return place


def put_atomically(write: Callable[[Path], None], place: Path) -> None:
    """Write a folder under another name, then rename it: a reader never finds half of it."""
    place.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix='.new-', dir=place.parents[2]) as aside:
        new = Path(aside, 'new')
        new.mkdir()
        write(new)
        if place.exists():
            place.rename(Path(aside, 'old'))
        new.rename(place)
