"""Read archives that nobody vouches for: nothing in them chooses where a byte is written.

Each file that is wanted is copied to a fresh name of ours in a folder of ours. The path that the
archive gives is only ever read as text, so no link, no `..` and no device can lead anywhere.
"""

import bz2
import errno
import gzip
import io
import lzma
import re
import stat
import struct
import tarfile
import tempfile
import unicodedata
import zipfile
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

MAX_FILE_BYTES = 50_000_000
"""A notebook with all its pictures has a few; one of over 20 MB is refused at grading."""
MAX_PARTS, MAX_NAME_BYTES = 20, 255
"""Folders within folders, and what a file system takes as a name."""
MAX_READ_BYTES = 8_000_000
"""A zip's table of contents and a tar's headers are read at once: so much names 50,000 files."""
CHUNK = 1 << 20

TAR_READERS = {'.tar': open, '.gz': gzip.open, '.tgz': gzip.open}
TAR_READERS |= {'.bz2': bz2.open, '.tbz2': bz2.open, '.xz': lzma.open, '.txz': lzma.open}
ARCHIVE = re.compile(r'\.(zip|tar|tgz|tbz2|txz|tar\.(gz|bz2|xz))$', re.IGNORECASE)
"""How names of archives end that can be read."""
OTHER_ARCHIVE = re.compile(r'\.(rar|7z|gz|bz2|xz|zst|lzh|cab|iso|dmg)$', re.IGNORECASE)

_BROKEN = (zipfile.BadZipFile, tarfile.TarError, zlib.error, lzma.LZMAError, EOFError, OSError)
_BROKEN += (ValueError, OverflowError, RuntimeError, struct.error, KeyError, IndexError)
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EMFILE)


@dataclass
class Allowance:
    """What may still be unpacked."""

    files: int
    bytes: int

    def part(self, *, files: int, bytes: int) -> 'Allowance':
        """Return an allowance of its own for one archive, within this one."""
        return Allowance(min(files, self.files), min(bytes, self.bytes))

    def less(self, part: 'Allowance', left: 'Allowance') -> None:
        """Take off what was used of a part."""
        self.files -= part.files - left.files
        self.bytes -= part.bytes - left.bytes


@dataclass(frozen=True)
class Member:
    """One entry of an archive that is not a folder; without parts, the archive itself."""

    parts: tuple[str, ...]
    """Its path, component by component."""
    modified: datetime | None = None
    file: Path | None = None
    """Where a copy of it lies, if it was wanted and nothing is wrong with it."""
    problem: str = ''
    """Why it was not unpacked."""


class _Refused(Exception):
    """Says in a sentence why there is no going on."""


class _Careful(io.FileIO):
    """A file of which nobody reads much at once, whatever lengths it claims to have."""

    def read(self, size: int = -1) -> bytes:
        if size > MAX_READ_BYTES:
            raise _Refused(f'broken: its table of contents claims {size / 1e6:.0f} MB')
        return super().read(size)


def unpack(
    archive: Path, *, name: str, aside: Path, left: Allowance, wanted: Callable[[str], bool]
) -> Iterator[Member]:
    """Yield what an archive holds; copies of wanted files, told by their names, lie in `aside`.

    `name` tells the kind of archive. Raises OSError where the disk is full, and nothing else:
    whatever is wrong with the archive is the problem of a member.
    """
    members = _zipped if name.lower().endswith('.zip') else _tarred
    try:
        for parts, modified, problem, content in members(archive, name, aside, left):
            left.files -= 1
            if left.files < 0:
                raise _Refused('more files in it than are unpacked')
            file = None
            if not problem and wanted(parts[-1]):
                file, problem = _copied(content, aside, left)
            yield Member(parts, modified, file, problem)
    except _Refused as refusal:
        yield Member((), problem=f'{refusal}; what lies behind that was not read')
    except _BROKEN as error:
        yield Member((), problem=_broken(error))


_Entry = tuple[tuple[str, ...], datetime | None, str, Callable[[], BinaryIO]]


def _zipped(archive: Path, name: str, aside: Path, left: Allowance) -> Iterator[_Entry]:
    with _Careful(archive) as raw, zipfile.ZipFile(raw) as box:
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
            yield parts, _local(info.date_time), problem, lambda info=info: box.open(info)


def _decoded(info: zipfile.ZipInfo) -> str:
    """Return a name as it was meant: many programs write UTF-8 and do not say so."""
    name = info.orig_filename
    if not info.flag_bits & 0x800:
        try:
            name = name.encode('cp437').decode()
        except UnicodeError:
            return name
    return name


def _local(date: tuple[int, ...]) -> datetime | None:
    """Return a zip's time, which is that of a wall clock, taken to be this machine's."""
    try:
        return datetime(*date).astimezone(UTC)
    except (ValueError, OverflowError, OSError):
        return None


def _tarred(archive: Path, name: str, aside: Path, left: Allowance) -> Iterator[_Entry]:
    reader = TAR_READERS[Path(name.lower()).suffix]
    with tempfile.TemporaryDirectory(dir=aside) as folder:
        plain = Path(folder, 'plain.tar')
        with reader(archive, 'rb') as packed, plain.open('wb') as unpacked:
            if not _copy(packed, unpacked, left.bytes):
                raise _Refused(f'over {left.bytes / 1e6:.0f} MB once unpacked: a bomb?')
        with _Careful(plain) as raw, tarfile.open(fileobj=raw, mode='r:') as box:
            while (info := box.next()) is not None:
                box.members.clear()  # a million headers need no memory
                if info.isdir():
                    continue
                parts, problem = _parts(info.name)
                if info.issym() or info.islnk():
                    problem = 'a link: only files are taken'
                elif not info.isreg() or info.issparse():
                    problem = 'a device or the like: only files are taken'
                yield parts, _utc(info.mtime), problem, lambda info=info: box.extractfile(info)
            raw.seek(box.offset)
            end = raw.read(tarfile.BLOCKSIZE)
            if len(end) < tarfile.BLOCKSIZE or any(end):
                raise _Refused('broken: it ends too early, or is no tar any more')


def _utc(seconds: float) -> datetime | None:
    try:
        return datetime.fromtimestamp(seconds, UTC)
    except (ValueError, OverflowError, OSError):
        return None


def _parts(path: str) -> tuple[tuple[str, ...], str]:
    """Split a path as Unix and Windows write it; say what is wrong with it."""
    path = path.replace('\\', '/')
    parts = tuple(unicodedata.normalize('NFC', part) for part in path.split('/') if part)
    problem = ''
    if path.startswith('/') or re.match('[A-Za-z]:', path):
        problem = 'its path is an absolute one'
    elif '..' in parts:
        problem = 'its path leads out of the archive'
    elif len(parts) > MAX_PARTS:
        problem = f'it lies more than {MAX_PARTS} folders deep'
    elif any(len(part.encode(errors='replace')) > MAX_NAME_BYTES for part in parts):
        problem = 'its name is longer than a file system takes'
    parts = tuple(part for part in parts if part != '.')
    return parts or ('.',), problem or ('' if parts else 'it has no name')


def _copied(
    content: Callable[[], BinaryIO], aside: Path, left: Allowance
) -> tuple[Path | None, str]:
    """Copy a member to a name of ours; return that, or why not."""
    most = min(MAX_FILE_BYTES, left.bytes)
    problem = f'over {most / 1e6:.0f} MB once unpacked: a bomb?'
    with tempfile.NamedTemporaryFile(dir=aside, delete=False) as target:
        try:
            with content() as source:
                if _copy(source, target, most):
                    problem = ''
        except _BROKEN as error:
            problem = _broken(error)
        finally:
            left.bytes -= target.tell()
            if problem:
                Path(target.name).unlink()
    return (None if problem else Path(target.name)), problem


def _broken(error: Exception) -> str:
    """Put into words what is wrong with an archive; raise it where it is the disk."""
    if isinstance(error, OSError) and error.errno in _FULL:
        raise error
    return f'broken: {" ".join(str(error).split()) or "it ends too early"}'


def _copy(source: BinaryIO, target: BinaryIO, most: int) -> bool:
    """Copy so many bytes at most; return whether that was all."""
    while chunk := source.read(min(CHUNK, most + 1)):
        most -= len(chunk)
        if most < 0:
            return False
        target.write(chunk)
    return True
