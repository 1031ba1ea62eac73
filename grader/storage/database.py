"""nbgrader's database as a file: made whole, waited for, written in one go."""

import errno
import logging
import os
import sqlite3
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from nbgrader.api import Base, Gradebook
from nbgrader.dbutil import ALEMBIC_DIR
from sqlalchemy import create_engine

from grader.common.errors import CourseError, GradebookError
from grader.course import Course

TIMEOUT_SEC = 60.0
"""How long another program may keep the database; the formgrader takes it for milliseconds."""

# nbgrader prints a traceback of what it raises all the same
logging.getLogger('tornado.application').addFilter(
    lambda record: not str(record.msg).startswith('Rolling back session')
)

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_BUSY = {sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED}
_DAMAGED = {sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB}


def make_ready(course: Course) -> None:
    """Make the gradebook's folder, and let nbgrader find the command that makes its database.

    nbgrader's own commands start it: nbgrader_config.py calls this first.
    """
    course.gradebook.mkdir(parents=True, exist_ok=True)
    programs = os.environ.get('PATH', os.defpath).split(os.pathsep)
    ours = str(Path(sys.executable).parent)  # where `alembic` is
    if ours not in programs:
        os.environ['PATH'] = os.pathsep.join([ours, *programs])


def make_database(course: Course) -> None:
    """Make the database where there is none: aside, for nbgrader would not repair half of one."""
    course.gradebook.mkdir(parents=True, exist_ok=True)
    if course.database.exists() and course.database.stat().st_size:
        return
    aside = course.database.with_name('.gradebook.db.new')
    for left in course.gradebook.glob(f'{aside.name}*'):  # of a run that was ended meanwhile
        left.unlink()
    _make_tables(f'sqlite:///{aside}')
    os.replace(aside, course.database)


def _make_tables(db_url: str) -> None:
    """Make nbgrader's tables, with the version of its schema.

    nbgrader would start `alembic`, which takes a second, to learn that version.
    """
    from alembic.runtime.migration import MigrationContext
    from alembic.script import ScriptDirectory

    engine = create_engine(db_url)
    Base.metadata.create_all(engine)
    with engine.begin() as connection:
        MigrationContext.configure(connection).stamp(ScriptDirectory(ALEMBIC_DIR), 'heads')
    engine.dispose()
    Gradebook(db_url).close()  # adds its course


def wait_until_free(course: Course, say: Callable[[str], None] = print) -> None:
    """Wait while another program holds the database, and say so. Raises GradebookError at last."""
    deadline, said = time.monotonic() + TIMEOUT_SEC, False
    with closing(sqlite3.connect(course.database, timeout=0, isolation_level=None)) as database:
        while True:
            try:
                database.execute('BEGIN EXCLUSIVE')
                database.execute('ROLLBACK')
                return
            except sqlite3.OperationalError as error:
                if error.sqlite_errorcode & 0xFF not in _BUSY or time.monotonic() > deadline:
                    raise
            if not said:
                say(f'waiting: another program is using {course.database}')
                said = True
            time.sleep(0.1)


_engines: dict[str, Gradebook | None] = {}
"""Of databases that are opened again and again just now."""


@contextmanager
def one_engine(db_url: str) -> Iterator[None]:
    """Let `connected` make what opens this database once: it costs more than all the rest.

    Each time the file is opened anew all the same, and let go at the end.
    """
    _engines[db_url] = None
    try:
        yield
    finally:
        del _engines[db_url]


@contextmanager
def connected(db_url: str) -> Iterator[Gradebook]:
    """Open the database; what is not committed at the end is forgotten."""
    book = _engines.get(db_url) or Gradebook(db_url)
    if db_url in _engines:
        _engines[db_url] = book
    with book:  # the end of its connections, which it makes again when it has to
        yield book


@contextmanager
def transaction(db_url: str) -> Iterator[Gradebook]:
    """Open the database; what nbgrader would commit cell by cell is committed at the end."""
    with connected(db_url) as book:
        commit, book.db.commit = book.db.commit, book.db.flush
        try:
            yield book
            commit()
        finally:
            book.db.commit = commit


@contextmanager
def in_sentences(course: Course) -> Iterator[None]:
    """Say in a GradebookError what a disk or a database can't do; other errors pass."""
    try:
        yield
    except Exception as error:
        if sentence := _sentence(error, course):
            raise GradebookError(sentence) from error
        raise


def _sentence(error: BaseException | None, course: Course) -> str | None:
    """Return what to tell of an error, or of what led to it: nbgrader wraps what it gets."""
    if error is None or isinstance(error, CourseError):
        return None
    code = getattr(error, 'sqlite_errorcode', 0) & 0xFF
    if code == sqlite3.SQLITE_FULL or (isinstance(error, OSError) and error.errno in _FULL):
        return (
            f'the disk is full: nothing more can be written into {course.gradebook}. What was '
            'stored before is kept, and no file is half written. Free some space, then run the '
            'same command again: it goes on.'
        )
    if code in _BUSY:
        return (
            f'another program has kept {course.database} locked for {TIMEOUT_SEC:.0f} s. What '
            'was stored before is kept. Close what has it open (a database browser, a '
            'formgrader that hangs), then run the same command again: it goes on.'
        )
    if code in _DAMAGED:
        backups = course.gradebook / 'backups'
        newest = max(backups.glob('*.db'), default=backups / 'NAME')
        return (
            f'{course.database} is damaged ({error}). Put a backup in its place with '
            f"cp '{newest}' '{course.database}', remove {course.database.name}-journal if there "
            'is one, then run ./course grade again.'
        )
    return _sentence(error.__cause__ or error.__context__, course)
