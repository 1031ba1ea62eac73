"""nbgrader's database, in a file or in PostgreSQL: made whole, waited for, written in one go."""

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

from grader.common.db_url import is_in_postgresql
from grader.common.errors import GradebookError
from grader.common.logs import tell
from grader.course import Course
from grader.storage import failures, postgresql
from grader.storage.failures import BUSY
from grader.storage.failures import in_sentences as in_sentences

# nbgrader prints a traceback of what it raises all the same
logging.getLogger('tornado.application').addFilter(
    lambda record: not str(record.msg).startswith('Rolling back session')
)


def make_ready(course: Course) -> None:
    """Make the gradebook's folder, and let nbgrader find the command that makes its database.

    nbgrader's own commands start it: nbgrader_config.py calls this first. Raises GradebookError
    in a command of nbgrader's where its database is in PostgreSQL, and can't be had.
    """
    course.gradebook.mkdir(parents=True, exist_ok=True)
    programs = os.environ.get('PATH', os.defpath).split(os.pathsep)
    ours = str(Path(sys.executable).parent)  # where `alembic` is
    if ours not in programs:
        os.environ['PATH'] = os.pathsep.join([ours, *programs])
    if is_in_postgresql(course.db_url) and 'nbgrader' in Path(sys.argv[0]).parts:
        with in_sentences(course):  # nbgrader would say that the database has to be upgraded
            make_database(course)


def has_database(course: Course) -> bool:
    """Whether there is a database yet."""
    if is_in_postgresql(course.db_url):
        return postgresql.has_tables(course.db_url)
    return course.database.exists()


def make_database(course: Course) -> None:
    """Make the database if there is none: aside, because nbgrader would not repair half of one.

    Raises GradebookError where there was one, and its file is empty.
    """
    course.gradebook.mkdir(parents=True, exist_ok=True)
    if is_in_postgresql(course.db_url):
        postgresql.make_tables(course.db_url)
        return
    _refuse_emptied(course)
    if course.database.exists() and course.database.stat().st_size:
        return
    aside = course.database.with_name('.gradebook.db.new')
    for left in course.gradebook.glob(f'{aside.name}*'):  # of a run that was ended meanwhile
        left.unlink()
    _make_tables(f'sqlite:///{aside}')
    os.replace(aside, course.database)


def _refuse_emptied(course: Course) -> None:
    """Raise GradebookError where the file has lost what it held: a new one has no scores."""
    if not course.database.exists() or course.database.stat().st_size:
        return
    backups = (course.gradebook / 'backups').glob('*.db')
    graded = course.folder('autograded', '', '').glob('*/*/*.ipynb')
    if any(backups) or any(graded):
        raise GradebookError(failures.damaged(course, 'the file is empty'))


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


def wait_until_free(course: Course, say: Callable[[str], None] = tell) -> None:
    """Wait while another program holds the database, and say so. Raises GradebookError at last.

    PostgreSQL serves several programs; there, wait for the server.
    """
    if is_in_postgresql(course.db_url):
        postgresql.wait_until_there(course.db_url, failures.TIMEOUT_SEC, say)
        return
    _refuse_emptied(course)
    deadline, said = time.monotonic() + failures.TIMEOUT_SEC, False
    with closing(sqlite3.connect(course.database, timeout=0, isolation_level=None)) as database:
        while True:
            try:
                database.execute('BEGIN EXCLUSIVE')
                database.execute('ROLLBACK')
                return
            except sqlite3.OperationalError as error:
                if error.sqlite_errorcode & 0xFF not in BUSY or time.monotonic() > deadline:
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

    Each time the file is opened anew all the same, and let go at the end of the outermost block.
    """
    if db_url in _engines:
        yield
        return
    _engines[db_url] = None
    try:
        yield
    finally:
        del _engines[db_url]


_connected: dict[str, Gradebook] = {}
"""Databases that are open just now."""


@contextmanager
def connected(db_url: str) -> Iterator[Gradebook]:
    """Open the database; what is not committed at the end is forgotten.

    A block inside another one has its connection, and what it has asked for is forgotten as well.
    """
    if open_already := _connected.get(db_url):
        try:
            yield open_already
        finally:
            open_already.db.remove()
        return
    book = _engines.get(db_url) or Gradebook(db_url)
    if db_url in _engines:
        _engines[db_url] = book
    _connected[db_url] = book
    try:
        with book:  # the end of its connections, which it makes again when it has to
            yield book
    finally:
        del _connected[db_url]


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
