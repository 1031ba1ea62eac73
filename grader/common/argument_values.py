"""Values of command line arguments that other packages interpret."""

from datetime import datetime, time

RECORDED = 'recorded'
"""Instead of a seed: the seed of a submission's stored result."""
PLATFORMS = ('canvas', 'moodle')
"""Course platforms that import scores: `grader/passback/write.py` has a table for each."""
END_OF_DAY = time(23, 59, 59)
"""The time that a date without a time gets."""


def local_time(text: str) -> datetime:
    """Read '2026-11-30', '2026-11-30 18:00' or a time with a zone; the default is the local zone.

    A local time can occur twice in the night when clocks are set back: then it is the later one.
    Raises ValueError for any other text.
    """
    found = datetime.fromisoformat(text)
    if len(text) <= len('2026-11-30'):
        found = datetime.combine(found, END_OF_DAY)
    return found if found.tzinfo else max(found.replace(fold=n).astimezone() for n in (0, 1))
