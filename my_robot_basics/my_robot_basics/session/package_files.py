"""Which files of a ROS package belong to a submission, and why the others do not.

A notebook builds only these files, and the grader collects the same ones: a package that lacks a
file lacks it in both places. Imports nothing that is slow.
"""

import os
import stat
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

MAX_FILES, MAX_BYTES = 200, 2_000_000
"""Limits of one package: a robot's driver has about thirty files, and pictures do not belong."""
MAX_DEPTH = 8
"""Folders in the package's folder, and the file, that a path may have."""
MAX_NAME_BYTES = 100
MOST_SEEN = 20_000
"""How many files and folders of a package are examined at most."""
MOST_REASONS = 20
"""How many files that are left out are named; of the others, only the number is reported."""

_BUILT = {'build', 'install', 'log'}
"""Folders that colcon creates where it is called; only those at the top of the package count."""
_LEFT_BEHIND = {'__pycache__', '__MACOSX', 'venv', 'Thumbs.db', 'desktop.ini'}
_BESIDE_LETTERS = frozenset('._-+@=, ()')


@dataclass(frozen=True)
class PackageFiles:
    """The files that are taken of a package, and the others; paths are relative to its folder."""

    taken: dict[str, Path]
    """The file to read for each path, such as 'resource/arm_player'."""
    left_out: tuple[str, ...]
    """A clause for each file or folder that is left out: its path, and why."""
    problem: str = ''
    """Why nothing of the package is taken."""


def read(folder: Path) -> PackageFiles:
    """Look through a package's folder without following links. Raises OSError if it can't."""
    sizes: dict[str, int] = {}
    left_out: list[str] = []
    for seen, (path, parts, reason) in enumerate(_walk(folder, ()), start=1):
        if seen > MOST_SEEN:
            return PackageFiles({}, (), f'it has more than {MOST_SEEN:,} files and folders')
        if reason:
            left_out.append(left_out_clause('/'.join(parts), reason))
        else:
            sizes['/'.join(parts)] = path.lstat().st_size
    problem = reason_too_large(sizes)
    taken = {} if problem else {name: folder / name for name in sorted(sizes)}
    return PackageFiles(taken, first_clauses(left_out), problem)


def reason_left_out(parts: Sequence[str]) -> str:
    """Say why a file with that path in the package's folder is left out; '' if it is taken."""
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


def reason_too_large(sizes: Mapping[str, int]) -> str:
    """Say why a package with files of these sizes is not taken at all; '' if it is."""
    if len(sizes) > MAX_FILES:
        what = f'it has {len(sizes):,} files, and at most {MAX_FILES} are taken'
    elif sum(sizes.values()) > MAX_BYTES:
        size = sum(sizes.values()) / 1e6
        what = f'it has {size:.1f} MB, and at most {MAX_BYTES / 1e6:.0f} MB are taken'
    else:
        return ''
    if top := _largest_folder(sizes):
        return f'{what}: remove what is no part of the package (most are in {top}/)'
    return f'{what}: remove what is no part of the package'


def left_out_clause(path: str, reason: str) -> str:
    """Return a clause with a path and why it is left out, without control characters."""
    shown = ''.join(c if c.isprintable() else '?' for c in path)
    return f'{shown if len(shown) <= 120 else shown[:119] + "…"} ({reason})'


def first_clauses(clauses: Sequence[str]) -> tuple[str, ...]:
    """Return the first MOST_REASONS clauses, and how many more there are."""
    more = len(clauses) - MOST_REASONS
    return (*clauses[:MOST_REASONS], *([f'and {more:,} more'] if more > 0 else []))


def write(files: Mapping[str, Path], folder: Path) -> None:
    """Copy files to their paths in a folder. Raises OSError if one is no longer a plain file.

    Only the content is copied: the copies belong to this user and are not executable.
    """
    for name, source in files.items():
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(read_plain_file(source))


def read_plain_file(file: Path) -> bytes:
    """Read a file, unless a link or device has replaced it meanwhile. Raises OSError."""
    descriptor = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with os.fdopen(descriptor, 'rb') as opened:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_size > MAX_BYTES:
            raise OSError(f'{file} is no plain file of at most {MAX_BYTES / 1e6:.0f} MB any more')
        return opened.read(MAX_BYTES)


def _walk(folder: Path, above: tuple[str, ...]) -> Iterator[tuple[Path, tuple[str, ...], str]]:
    """Yield each file, its path and why it is left out; a folder that is left out comes alone."""
    for path in sorted(islice(folder.iterdir(), MOST_SEEN + 1)):
        if path.name == '__pycache__':  # not worth a message: each import creates one
            continue
        parts = (*above, path.name)
        mode = path.lstat().st_mode
        is_folder = stat.S_ISDIR(mode)
        # 'x' stands for a file in the folder, so that the folder's name is judged as a folder's
        if reason := reason_left_out((*parts, 'x') if is_folder else parts):
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


def _largest_folder(sizes: Mapping[str, int]) -> str:
    """Return the top-level folder with more than half of MAX_FILES files; '' if none has."""
    counts: dict[str, int] = {}
    for name in sizes:
        top, slash, _ = name.partition('/')
        if slash:
            counts[top] = counts.get(top, 0) + 1
    top = max(counts, key=lambda name: counts[name], default='')
    return top if counts and counts[top] > MAX_FILES // 2 else ''
