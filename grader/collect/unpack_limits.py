"""How much is unpacked of an archive, and of the archives in it."""

from dataclasses import dataclass


@dataclass
class UnpackLimits:
    """What may still be unpacked."""

    files: int
    bytes: int
    tar_bytes: int = -1
    """Of tars, which are unpacked whole before any file of them is copied; as many as `bytes`."""

    def __post_init__(self) -> None:
        """Let tars have as many bytes, unless they are told."""
        if self.tar_bytes < 0:
            self.tar_bytes = self.bytes

    def part(self, *, files: int, bytes: int) -> 'UnpackLimits':
        """Return an allowance of its own for one archive, within this one."""
        return UnpackLimits(
            min(files, self.files), min(bytes, self.bytes), min(bytes, self.tar_bytes)
        )

    def less(self, part: 'UnpackLimits', left: 'UnpackLimits') -> None:
        """Take off what was used of a part."""
        self.files -= part.files - left.files
        self.bytes -= part.bytes - left.bytes
        self.tar_bytes -= part.tar_bytes - left.tar_bytes
