"""How much may be unpacked of an archive, and of the archives in it."""

from dataclasses import dataclass


@dataclass
class UnpackLimits:
    """What may still be unpacked."""

    files: int
    bytes: int
    tar_bytes: int = -1
    """For decompressed tars, before their files are copied; by default the same as `bytes`."""

    def __post_init__(self) -> None:
        """Set the default of `tar_bytes`."""
        if self.tar_bytes < 0:
            self.tar_bytes = self.bytes

    def part(self, *, files: int, bytes: int) -> 'UnpackLimits':
        """Return limits for one archive, within these limits."""
        return UnpackLimits(
            min(files, self.files), min(bytes, self.bytes), min(bytes, self.tar_bytes)
        )

    def subtract_used(self, part: 'UnpackLimits', left: 'UnpackLimits') -> None:
        """Subtract what was used of a part."""
        self.files -= part.files - left.files
        self.bytes -= part.bytes - left.bytes
        self.tar_bytes -= part.tar_bytes - left.tar_bytes
