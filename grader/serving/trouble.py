"""What went wrong with one submission and costs only that one, and what would meet all."""

import logging
import sqlite3

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError

from grader.common.errors import (
    MACHINE_FULL,
    CourseError,
    DamagedResult,
    TaskFailed,
    UnreadableSubmission,
)
from grader.common.text import printable

_OF_ONE = (UnreadableSubmission, DamagedResult, TaskFailed)


def meets_all(error: Exception) -> bool:
    """Whether the next one would meet it, too: of the disk, the gradebook or the course."""
    if isinstance(error, OSError):
        return error.errno in MACHINE_FULL
    if isinstance(error, DBAPIError):  # what SQLite or PostgreSQL says, as SQLAlchemy tells it
        return not isinstance(error, DataError | IntegrityError)
    return isinstance(error, CourseError | sqlite3.Error) and not isinstance(error, _OF_ONE)


def noted(which: str, error: Exception) -> str:
    """Log what nobody has expected, and return it for a line and the list of submissions."""
    logging.error('%s', printable(which), exc_info=error)
    return f'the grader failed: {type(error).__name__}: {error}'
