"""A file for a course platform to import, before it is written."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ImportFile:
    """A table for a platform."""

    text: str
    rows: int
    """How many students are in it."""
    left_out: tuple[str, ...]
    """For each student who has a score but is not in the table, the reason."""
    notes: tuple[str, ...] = ()
    """What a person should know before the platform imports it."""
