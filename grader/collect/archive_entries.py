"""List the files in a zip or tar of unknown origin: its paths are only read as text."""

import bz2
import gzip
import io
import lzma
import re
import stat
import tarfile
import tempfile
import unicodedata
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import IO, Any, cast

from grader.collect.unpack_limits import UnpackLimits
from grader.common.dates import utc_of

MAX_PARTS, MAX_NAME_BYTES = 20, 255
"""How many folders deep a path may be, and how long a name may be in a file system."""
MAX_READ_BYTES = 8_000_000
"""A zip's directory and a tar's headers are read at once: this is enough for 50,000 files."""
CHUNK = 1 << 20

TAR_READERS: dict[str, Callable[..., Any]] = {'.tar': open, '.gz': gzip.open, '.tgz': gzip.open}
TAR_READERS |= {'.bz2': bz2.open, '.tbz2': bz2.open, '.xz': lzma.open, '.txz': lzma.open}
ARCHIVE = re.compile(r'\.(zip|tar|tgz|tbz2|txz|tar\.(gz|bz2|xz))$', re.IGNORECASE)
"""File name endings of archives that can be read."""


@dataclass(frozen=True)
class ArchiveEntry:
    """What an archive says about a file in it."""

    parts: tuple[str, ...]
    """Its path, component by component."""
    modified: datetime | None
    """In UTC; None if the archive has no valid time."""
    problem: str
    """Why it must not be unpacked, or ''."""
    content: Callable[[], IO[bytes]]
    """Opens the file; reading it can still raise any error of a broken archive."""


class ArchiveRefused(Exception):
    """Why reading can't go on, in a sentence."""


def read_entries(
    archive: Path, *, name: str, aside: Path, left: UnpackLimits
) -> Iterator[ArchiveEntry]:
    """Yield the files that an archive lists, without folders.

    `name` shows the kind of archive. A tar is decompressed into `aside` first, and its size is
    subtracted from `left`. Raises ArchiveRefused, and whatever Python raises for a broken archive.
    """
    if name.lower().endswith('.zip'):
        yield from _zip_entries(archive)
    else:
        yield from _tar_entries(archive, name=name, aside=aside, left=left)


def copy_at_most(source: IO[bytes], target: IO[bytes], *, most: int) -> bool:
    """Copy `most` bytes at most; return whether that was all."""
    while chunk := source.read(min(CHUNK, most + 1)):
        most -= len(chunk)
        if most < 0:
            return False
        target.write(chunk)
    return True


class _BoundedReads(io.FileIO):
    """A file from which a single read can't get much, whatever length the archive claims."""

    def read(self, size: int | None = -1) -> bytes:
        if size is not None and size > MAX_READ_BYTES:
            raise ArchiveRefused(f'broken: its table of contents claims {size / 1e6:.0f} MB')
        return super().read(size)


def _zip_entries(archive: Path) -> Iterator[ArchiveEntry]:
    with _BoundedReads(archive) as raw, zipfile.ZipFile(raw) as box:
        for info in box.infolist():
            if info.is_dir():
                continue
            parts, problem = _parts(_decoded(info))
            kind = stat.S_IFMT(info.external_attr >> 16)
            if kind == stat.S_IFLNK:
                problem = 'a link: only files are taken'
            elif kind not in (0, stat.S_IFREG):
                problem = 'a device or the like: only files are taken'
            elif info.flag_bits & 1:
                problem = 'encrypted: ask for it without a password'
            yield ArchiveEntry(parts, _local(info.date_time), problem, partial(box.open, info))


def _decoded(info: zipfile.ZipInfo) -> str:
    """Return a name in its real encoding: many programs write UTF-8 without the flag for it."""
    name = info.orig_filename
    if not info.flag_bits & 0x800:
        try:
            name = name.encode('cp437').decode()
        except UnicodeError:
            return name
    return name


def _local(date: tuple[int, int, int, int, int, int]) -> datetime | None:
    """Return a zip's time in UTC: it has no zone, and is taken as this machine's local time."""
    try:
        return datetime(*date).astimezone(UTC)
    except (ValueError, OverflowError, OSError):
        return None


def _tar_entries(
    archive: Path, *, name: str, aside: Path, left: UnpackLimits
) -> Iterator[ArchiveEntry]:
    with tempfile.TemporaryDirectory(dir=aside) as folder:
        plain = Path(folder, 'plain.tar')
        _decompress(archive, plain, name=name, left=left)
        with _BoundedReads(plain) as raw, tarfile.open(fileobj=raw, mode='r:') as box:
            while (info := box.next()) is not None:
                box.members.clear()  # type: ignore[attr-defined]  # typeshed has no such attribute; a million headers need no memory
                if info.isdir():
                    continue
                parts, problem = _parts(info.name)
                if info.issym() or info.islnk():
                    problem = 'a link: only files are taken'
                elif not info.isreg() or info.issparse():
                    problem = 'a device or the like: only files are taken'
                # extractfile returns None if it is not a file, but then there is a problem
                content = cast('partial[IO[bytes]]', partial(box.extractfile, info))
                yield ArchiveEntry(parts, utc_of(info.mtime), problem, content)
            raw.seek(box.offset)
            end = raw.read(tarfile.BLOCKSIZE)
            if len(end) < tarfile.BLOCKSIZE or any(end):
                raise ArchiveRefused('broken: it ends too early, or is no tar any more')


def _decompress(archive: Path, plain: Path, *, name: str, left: UnpackLimits) -> None:
    """Decompress a tar; all its bytes count, because there may be a thousand like it."""
    most = min(left.bytes, left.archive_bytes)
    if most <= 0:
        raise ArchiveRefused(
            'not unpacked, because what came before it was too large together: a bomb?'
        )
    reader, is_whole = TAR_READERS[Path(name.lower()).suffix], False
    with reader(archive, 'rb') as packed, plain.open('wb') as unpacked:
        try:
            is_whole = copy_at_most(packed, unpacked, most=most)
        finally:
            read = unpacked.tell() + (0 if is_whole else CHUNK)
            left.archive_bytes -= min(left.archive_bytes, read)
    if not is_whole:
        raise ArchiveRefused(f'over {most / 1e6:.0f} MB once unpacked: a bomb?')


def _parts(path: str) -> tuple[tuple[str, ...], str]:
    """Split a path of Unix or Windows into components; return what is wrong with it."""
    path = path.replace('\\', '/')
    parts = tuple(unicodedata.normalize('NFC', part) for part in path.split('/') if part)
    problem = ''
    if path.startswith('/') or re.match('[A-Za-z]:', path):
        problem = 'its path is an absolute one'
    elif '..' in parts:
        problem = 'its path leads out of the archive'
    elif len(parts) > MAX_PARTS:
        problem = f'it is more than {MAX_PARTS} folders deep'
    elif any(len(part.encode(errors='replace')) > MAX_NAME_BYTES for part in parts):
        problem = 'its name is longer than a file system takes'
    parts = tuple(part for part in parts if part != '.')
    return parts or ('.',), problem or ('' if parts else 'it has no name')
