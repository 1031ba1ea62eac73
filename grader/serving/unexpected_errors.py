"""Distinguish errors of a single submission from those that would affect all submissions."""

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


def affects_all_submissions(error: Exception) -> bool:
    """Whether an error would affect the next submission, too: of disk, gradebook or course."""
    if isinstance(error, OSError):
        return error.errno in MACHINE_FULL
    if isinstance(error, DBAPIError):  # an error of SQLite or PostgreSQL, wrapped by SQLAlchemy
        return not isinstance(error, DataError | IntegrityError)
    return isinstance(error, CourseError | sqlite3.Error) and not isinstance(error, _OF_ONE)


def log_unexpected_error(which: str, error: Exception) -> str:
    """Log an unexpected error; return it as text for the terminal and the list of submissions."""
    logging.error('%s', printable(which), exc_info=error)
    return f'the grader failed: {type(error).__name__}: {error}'
