"""What a course platform imports, before it is written."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ImportFile:
    """A table for a platform."""

    text: str
    rows: int
    """How many students are in it."""
    left_out: tuple[str, ...]
    """For each student who has a score and is not in it, why."""
