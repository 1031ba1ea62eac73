"""How much may be unpacked of an archive, and of the archives in it."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import astuple, dataclass, replace

ONE = {'files': 5_000, 'bytes': 200_000_000}
"""Limits for one student's archive or folder, which may include the course's whole bundle."""
OF_USER = {'files': 20_000, 'bytes': 1_000_000_000}
"""The same for all folders of one user of this machine, and for all their archives: the exchange
keeps every submission, and sparse files take no space on their owner's disk. Also for all archives
that a student has handed in on a course platform."""


@dataclass
class UnpackLimits:
    """What may still be unpacked."""

    files: int
    bytes: int
    archive_bytes: int = -1
    """For archives in a folder, and for decompressed tars, before the files in them are copied; by
    default the same as `bytes`."""

    def __post_init__(self) -> None:
        """Set the default of `archive_bytes`."""
        if self.archive_bytes < 0:
            self.archive_bytes = self.bytes

    def part(self, *, files: int, bytes: int) -> 'UnpackLimits':
        """Return limits for one archive, within these limits."""
        return UnpackLimits(
            min(files, self.files), min(bytes, self.bytes), min(bytes, self.archive_bytes)
        )

    def claim(self, size: int, *, most: int, is_archive: bool) -> str:
        """Subtract the size of a file in a folder; if it may not be read, return why instead."""
        if size > most:
            return f'over {most / 1e6:.0f} MB: ask for it without outputs'
        if size > (self.archive_bytes if is_archive else self.bytes):
            return 'it was not read, because what came before it was too large together'
        if is_archive:
            self.archive_bytes -= size
        else:
            self.bytes -= size
        return ''

    @contextmanager
    def lend(self, *others: 'UnpackLimits', files: int, bytes: int) -> Iterator['UnpackLimits']:
        """Yield limits for one archive or folder; subtract what the block has used of them.

        It is within the `others`, too, and subtracted from them.
        """
        left = self.part(files=files, bytes=bytes)
        for other in others:
            left = UnpackLimits(*map(min, astuple(left), astuple(other)))
        before = replace(left)
        try:
            yield left
        finally:
            for each in (self, *others):
                each._subtract_used(before, left)

    def _subtract_used(self, part: 'UnpackLimits', left: 'UnpackLimits') -> None:
        self.files -= part.files - left.files
        self.bytes -= part.bytes - left.bytes
        self.archive_bytes -= part.archive_bytes - left.archive_bytes
