"""Errors of a disk or a database in sentences; does not import nbgrader's database code."""

import errno
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from grader.common.db_url import is_in_postgresql
from grader.common.errors import DISK_FULL, CourseError, GradebookError
from grader.course import Course

TIMEOUT_SEC = 60.0
"""How long another program may lock the database; the formgrader locks it for milliseconds."""
BUSY = {sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED}
"""SQLite's errors for a database that another program has locked."""

_FULL = {*DISK_FULL, errno.EFBIG}
_REFUSED = {errno.EACCES, errno.EPERM}
_NOT_WRITTEN = {sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_PERM}
_DAMAGED = {sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB}


def backups_of(course: Course) -> Path:
    """Return the folder with copies of the database."""
    return course.gradebook / 'backups'


def newest_backup(course: Course) -> Path | None:
    """Return the newest copy of the database, if there is one."""
    return max(backups_of(course).glob('*.db'), default=None)


def gone_message(course: Course) -> str:
    """Return the message for a database that is not there, although there were scores in it."""
    newest = newest_backup(course)
    if newest is None:
        return (
            f'{course.database} is gone, and {backups_of(course)} has no copy of it: put yours in '
            'its place. Without one, run ./course grade: what was scored by hand is lost then.'
        )
    return (
        f"{course.database} is gone. Put a backup in its place with cp '{newest}' "
        f"'{course.database}', then run the same command again. To begin without any scores, also "
        f'of those given by hand, move {backups_of(course)} away first.'
    )


def damaged_message(course: Course, why: str) -> str:
    """Return the message for a database that lost its content, and how to restore it."""
    found = f'{course.database} is damaged ({why}).'
    newest = newest_backup(course)
    if newest is None:
        return (
            f'{found} There is no backup in {backups_of(course)}: put a copy of yours in its '
            'place. Without one, move the file away and run ./course grade: what was scored by '
            'hand is lost then.'
        )
    return (
        f"{found} Put a backup in its place with cp '{newest}' '{course.database}', remove "
        f'{course.database.name}-journal if there is one, then run ./course grade again.'
    )


@contextmanager
def raise_gradebook_errors(course: Course) -> Iterator[None]:
    """Turn an error of a disk or a database into a GradebookError; other errors pass."""
    try:
        yield
    except Exception as error:
        if sentence := _sentence(error, course):
            raise GradebookError(sentence) from error
        raise


def _sentence(error: BaseException | None, course: Course) -> str | None:
    """Return the message for an error or for its cause, because nbgrader wraps errors; or None."""
    if error is None or isinstance(error, CourseError):
        return None
    if is_in_postgresql(course.db_url):
        from grader.storage.postgresql import message_of  # imports nbgrader's database code

        if told := message_of(error, course.db_url):
            return told
    code = getattr(error, 'sqlite_errorcode', 0) & 0xFF
    if code == sqlite3.SQLITE_FULL or (isinstance(error, OSError) and error.errno in _FULL):
        return (
            f'the disk is full: nothing more can be written into {course.gradebook}. What was '
            'stored before is kept, and no file is half written. Free some space, then run the '
            'same command again: it goes on.'
        )
    if code in BUSY:
        return (
            f'another program has kept {course.database} locked for {TIMEOUT_SEC:.0f} s. What '
            'was stored before is kept. Close what has it open (a database browser, a '
            'formgrader that hangs), then run the same command again: it goes on.'
        )
    if code in _DAMAGED:
        return damaged_message(course, str(error))
    if code in _NOT_WRITTEN:
        return _refused_message(course.gradebook, 'written', str(error), 'write')
    if isinstance(error, OSError) and error.filename is not None:
        if error.errno == errno.EROFS:
            return _refused_message(error.filename, 'written', error.strerror, 'write')
        if error.errno in _REFUSED:
            return _refused_message(error.filename, 'used', error.strerror, 'read and write')
    return _sentence(error.__cause__ or error.__context__, course)


def _refused_message(path: object, done: str, why: str | None, right: str) -> str:
    return (
        f'{path} cannot be {done}: {why}. What was stored before is kept. Give this user the '
        f'right to {right} there (or remount it), then run the same command again.'
    )
