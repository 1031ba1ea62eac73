"""Which files of a ROS package belong to what a student hands in, and why the others do not.

A notebook builds what is taken here, and the grader takes the same: a package that lacks a file
lacks it in both places. Imports nothing that is slow.
"""

import os
import stat
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

MAX_FILES, MAX_BYTES = 200, 2_000_000
"""Of one package: a robot's own driver has some thirty files, and pictures are no part of it."""
MAX_DEPTH = 8
"""Folders and file, from the package's folder on."""
MAX_NAME_BYTES = 100
MOST_SEEN = 20_000
"""Entries of a folder that are looked at."""
MOST_REASONS = 20
"""Of files that are left out, each by name; of more, their number is told."""

_BUILT = {'build', 'install', 'log'}
"""What colcon writes where it is called: in the package's own folder, nobody else's."""
_LEFT_BEHIND = {'__pycache__', '__MACOSX', 'venv', 'Thumbs.db', 'desktop.ini'}
_BESIDE_LETTERS = frozenset('._-+@=, ()')


@dataclass(frozen=True)
class PackageFiles:
    """What is taken of a package, and what is not; paths begin in its folder."""

    taken: dict[str, Path]
    """Where each file can be read, by its path: 'resource/arm_player'."""
    left_out: tuple[str, ...]
    """A clause for each file or folder that is left out: its path, and why."""
    problem: str = ''
    """Why nothing of it is taken."""


def read(folder: Path) -> PackageFiles:
    """Look through a package's folder; no link is followed. Raises OSError where it can't be."""
    sizes: dict[str, int] = {}
    left_out: list[str] = []
    for seen, (path, parts, reason) in enumerate(_walk(folder, ()), start=1):
        if seen > MOST_SEEN:
            return PackageFiles({}, (), f'it has more than {MOST_SEEN:,} files and folders')
        if reason:
            left_out.append(told('/'.join(parts), reason))
        else:
            sizes['/'.join(parts)] = path.lstat().st_size
    problem = too_much(sizes)
    taken = {} if problem else {name: folder / name for name in sorted(sizes)}
    return PackageFiles(taken, few(left_out), problem)


def why_not(parts: Sequence[str]) -> str:
    """Why a file of that path, from the package's folder on, is left out; '' where it is not."""
    for at, part in enumerate(parts):
        is_folder = at < len(parts) - 1
        if part.startswith('.'):
            return 'hidden'
        if part in _LEFT_BEHIND or (is_folder and part.endswith('.egg-info')):
            return 'left behind by a program'
        if at == 0 and is_folder and part in _BUILT:
            return 'made by a build, which is done again at grading'
        if not _is_plain(part):
            return 'its name is not made of letters, digits and ' + ' '.join('._-')
        if len(part.encode(errors='replace')) > MAX_NAME_BYTES:
            return f'its name is longer than {MAX_NAME_BYTES} bytes'
    if len(parts) > MAX_DEPTH:
        return f'it is more than {MAX_DEPTH} folders deep'
    return ''


def too_much(sizes: Mapping[str, int]) -> str:
    """Why a package of files with these sizes is not taken at all; '' where it is."""
    if len(sizes) > MAX_FILES:
        what = f'it has {len(sizes):,} files, and at most {MAX_FILES} are taken'
    elif sum(sizes.values()) > MAX_BYTES:
        size = sum(sizes.values()) / 1e6
        what = f'it has {size:.1f} MB, and at most {MAX_BYTES / 1e6:.0f} MB are taken'
    else:
        return ''
    if top := _holds_most(sizes):
        return f'{what}: remove what is no part of the package (most are in {top}/)'
    return f'{what}: remove what is no part of the package'


def told(path: str, reason: str) -> str:
    """A clause that says of a path why it is left out; nothing in it moves a cursor."""
    shown = ''.join(c if c.isprintable() else '?' for c in path)
    return f'{shown if len(shown) <= 120 else shown[:119] + "…"} ({reason})'


def few(clauses: Sequence[str]) -> tuple[str, ...]:
    """The first of many clauses, and how many more there are."""
    more = len(clauses) - MOST_REASONS
    return (*clauses[:MOST_REASONS], *([f'and {more:,} more'] if more > 0 else []))


def write(files: Mapping[str, Path], folder: Path) -> None:
    """Copy files to their paths in a folder. Raises OSError where one is no plain file any more.

    They become ours: none can be run by itself, and what they may be is not what they were.
    """
    for name, source in files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content(source))


def content(file: Path) -> bytes:
    """Read a plain file, and nothing that was put in its place meanwhile. Raises OSError."""
    descriptor = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(descriptor, 'rb') as opened:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_size > MAX_BYTES:
            raise OSError(f'{file} is no plain file of at most {MAX_BYTES / 1e6:.0f} MB any more')
        return opened.read(MAX_BYTES)


def _walk(folder: Path, above: tuple[str, ...]) -> Iterator[tuple[Path, tuple[str, ...], str]]:
    """Yield each file, its path and why it is left out; of a folder that is, only itself."""
    for path in sorted(islice(folder.iterdir(), MOST_SEEN + 1)):
        if path.name == '__pycache__':  # nobody wrote it: each import makes one
            continue
        parts = (*above, path.name)
        mode = path.lstat().st_mode
        is_folder = stat.S_ISDIR(mode)
        # a folder's own name is judged as that of a folder
        if reason := why_not((*parts, 'x') if is_folder else parts):
            yield path, parts, reason
        elif stat.S_ISLNK(mode):
            yield path, parts, 'a link: only files are taken'
        elif is_folder:
            yield from _walk(path, parts)
        elif stat.S_ISREG(mode):
            yield path, parts, ''
        else:
            yield path, parts, 'a device or the like: only files are taken'


def _is_plain(name: str) -> bool:
    return (
        bool(name)
        and unicodedata.normalize('NFC', name) == name
        and all(c.isalnum() or c in _BESIDE_LETTERS for c in name)
        and not name.startswith(('-', ' '))
    )


def _holds_most(sizes: Mapping[str, int]) -> str:
    """The folder in the package's in which most of the files lie; '' where none has so many."""
    counts: dict[str, int] = {}
    for name in sizes:
        top, slash, _ = name.partition('/')
        if slash:
            counts[top] = counts.get(top, 0) + 1
    top = max(counts, key=lambda name: counts[name], default='')
    return top if counts and counts[top] > MAX_FILES // 2 else ''
