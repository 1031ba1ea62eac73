"""Words that a command line may hold and that mean something further down."""

from datetime import datetime, time

RECORDED = 'recorded'
"""Stands for the seed that a submission's stored result came from."""
PLATFORMS = ('canvas', 'moodle')
"""Course platforms that import scores: `grader/passback/write.py` has a table for each."""
END_OF_DAY = time(23, 59)
"""What a date without a time stands for."""


def local_time(text: str) -> datetime:
    """Read '2026-11-30', '2026-11-30 18:00' or a time with its zone; ours is taken without one.

    In the night in which clocks are changed, a time may mean two moments: the later one is taken.
    Raises ValueError on anything else.
    """
    found = datetime.fromisoformat(text)
    if len(text) <= len('2026-11-30'):
        found = datetime.combine(found, END_OF_DAY)
    return found if found.tzinfo else max(found.replace(fold=n).astimezone() for n in (0, 1))
