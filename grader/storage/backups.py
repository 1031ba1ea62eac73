"""Backups of the database, made before each run that writes into it."""

import os
import sqlite3
import sys
from contextlib import closing
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from grader.common.db_url import is_in_postgresql
from grader.course import Course
from grader.storage.database import has_database, wait_until_free
from grader.storage.dumps import dump
from grader.storage.failures import backups_of, raise_gradebook_errors
from grader.storage.gradebook import recover

KEPT = 10
"""How many backups are kept; a new one replaces the oldest."""


def recover_and_back_up(course: Course) -> None:
    """Before a run: finish what a killed run had begun, and back up the database."""
    recover(course)
    with raise_gradebook_errors(course):
        if has_database(course):
            wait_until_free(course)
            back_up(course)


def back_up(course: Course) -> Path | None:
    """Copy the database into gradebook/backups/, unless the newest copy is the same.

    Returns the newest copy; None if there is no database, or if pg_dump can't dump PostgreSQL.
    Raises sqlite3.DatabaseError, and keeps the copies that there are, if the database is
    damaged.
    """
    if not has_database(course):
        return None
    folder = backups_of(course)
    if is_in_postgresql(course.db_url):
        return dump(course.db_url, folder, KEPT, partial(print, file=sys.stderr))
    folder.mkdir(exist_ok=True)
    written = course.database.stat().st_mtime_ns
    backups = sorted(folder.glob('gradebook-*.db'))
    if backups and backups[-1].stat().st_mtime_ns == written:
        return backups[-1]
    aside = folder / '.new.db'
    try:
        _copy(course.database, aside)
        os.utime(aside, ns=(written, written))
        backup = folder / f'gradebook-{datetime.now(UTC):%Y-%m-%dT%H-%M-%S.%fZ}.db'
        os.replace(aside, backup)
    finally:
        for left in folder.glob(f'{aside.name}*'):
            left.unlink()
    for old in [*backups, backup][:-KEPT]:
        old.unlink()
    return backup


def _copy(database: Path, copy: Path) -> None:
    copy.unlink(missing_ok=True)
    with closing(sqlite3.connect(database)) as source, closing(sqlite3.connect(copy)) as target:
        source.backup(target)
        [verdict] = target.execute('PRAGMA quick_check(1)').fetchone()
    if verdict != 'ok':
        error = sqlite3.DatabaseError(verdict)
        error.sqlite_errorcode = sqlite3.SQLITE_CORRUPT
        raise error
