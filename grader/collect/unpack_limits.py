"""How much may be unpacked of an archive, and of the archives in it."""

from dataclasses import dataclass


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

    def subtract_used(self, part: 'UnpackLimits', left: 'UnpackLimits') -> None:
        """Subtract what was used of a part."""
        self.files -= part.files - left.files
        self.bytes -= part.bytes - left.bytes
        self.archive_bytes -= part.archive_bytes - left.archive_bytes
