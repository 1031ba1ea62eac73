"""Unpack archives of unknown origin: nothing in them decides where a file is written.

Each file that is wanted is copied to a new name that we choose, in a folder of ours. The path in
the archive is only read as text, so a link, `..` or a device in it has no effect.
"""

import lzma
import struct
import tarfile
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from grader.collect.archive_entries import ArchiveEntry, ArchiveRefused, copy_at_most, read_entries
from grader.collect.unpack_limits import UnpackLimits
from grader.common.errors import MACHINE_FULL
from grader.common.text import shorten

MAX_FILE_BYTES = 50_000_000
"""A notebook with pictures has a few MB; one of over 20 MB is refused when it is graded."""

_BROKEN: tuple[type[Exception], ...] = (
    zipfile.BadZipFile,
    tarfile.TarError,
    zlib.error,
    lzma.LZMAError,
    EOFError,
    OSError,
)
_BROKEN += (ValueError, OverflowError, RuntimeError, struct.error, KeyError, IndexError)


@dataclass(frozen=True)
class Member:
    """One entry of an archive that is not a folder; without parts, the archive itself."""

    parts: tuple[str, ...]
    """Its path in the archive, component by component."""
    modified: datetime | None = None
    file: Path | None = None
    """The path of its copy; None if it was not wanted or has a problem."""
    problem: str = ''
    """Why it was not unpacked, or ''."""


def unpack(
    archive: Path,
    *,
    name: str,
    aside: Path,
    left: UnpackLimits,
    wanted: Callable[[tuple[str, ...]], bool],
) -> Iterator[Member]:
    """Yield the entries of an archive; files whose path is `wanted` are copied into `aside`.

    `name` shows the kind of archive. Raises OSError if the disk is full, and nothing else:
    whatever is wrong with the archive is the problem of a member.
    """
    is_empty = True
    try:
        for entry in read_entries(archive, name=name, aside=aside, left=left):
            is_empty = False
            left.files -= 1
            if left.files < 0:
                raise ArchiveRefused('more files in it than are unpacked')
            file, problem = None, entry.problem
            if not problem and wanted(entry.parts):
                file, problem = _copy_aside(entry, aside, left)
            yield Member(entry.parts, entry.modified, file, problem)
        if is_empty:
            yield Member(
                (), problem='there is no file in it: if work is missing, ask for it once more'
            )
    except ArchiveRefused as refusal:
        yield Member((), problem=f'{refusal}; what comes after that was not read')
    except _BROKEN as error:
        yield Member((), problem=_damage_message(error))


def _copy_aside(entry: ArchiveEntry, aside: Path, left: UnpackLimits) -> tuple[Path | None, str]:
    """Copy an entry to a new name in `aside`; return its path, or the problem."""
    most = min(MAX_FILE_BYTES, left.bytes)
    problem = f'over {most / 1e6:.0f} MB once unpacked: a bomb?'
    with tempfile.NamedTemporaryFile(dir=aside, delete=False) as target:
        try:
            with entry.content() as source:
                if copy_at_most(source, target, most=most):
                    problem = ''
        except _BROKEN as error:
            problem = _damage_message(error)
        finally:
            left.bytes -= target.tell()
            if problem:
                Path(target.name).unlink()
    return (None if problem else Path(target.name)), problem


def _damage_message(error: Exception) -> str:
    """Describe what is wrong with an archive; re-raise if the disk or the memory is full."""
    if isinstance(error, OSError) and error.errno in MACHINE_FULL:
        raise error
    why = shorten(' '.join(str(error).split()), 100) or 'it ends too early'
    return f'broken: {why}; get it again, or collect the folder that it was made from'
