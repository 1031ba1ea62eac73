"""nbgrader's database, in a file or in PostgreSQL: create it, wait for it, write to it."""

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
from grader.common.logs import print_at_once
from grader.course import Course
from grader.storage import failures, postgresql
from grader.storage.failures import BUSY
from grader.storage.failures import raise_gradebook_errors as raise_gradebook_errors

# nbgrader raises the error anyway; this only hides its traceback
logging.getLogger('tornado.application').addFilter(
    lambda record: not str(record.msg).startswith('Rolling back session')
)


def make_ready(course: Course) -> None:
    """Make the gradebook's folder, and put `alembic`, which nbgrader runs, on PATH.

    nbgrader_config.py calls this at the start of nbgrader's own commands. Raises GradebookError if
    such a command needs a database in PostgreSQL that is not available.
    """
    course.gradebook.mkdir(parents=True, exist_ok=True)
    programs = os.environ.get('PATH', os.defpath).split(os.pathsep)
    ours = str(Path(sys.executable).parent)  # where `alembic` is
    if ours not in programs:
        os.environ['PATH'] = os.pathsep.join([ours, *programs])
    if is_in_postgresql(course.db_url) and 'nbgrader' in Path(sys.argv[0]).parts:
        # nbgrader would only say that the database must be upgraded
        with raise_gradebook_errors(course):
            make_database(course)


def has_database(course: Course) -> bool:
    """Whether the database exists. Raises GradebookError if it is gone, and has backups."""
    if is_in_postgresql(course.db_url):
        return postgresql.has_tables(course.db_url)
    _refuse_gone(course)
    return course.database.exists()


def make_database(course: Course) -> None:
    """Make the database if there is none, under another name: nbgrader can't repair half of one.

    Raises GradebookError if its file is empty or gone although there were results before.
    """
    course.gradebook.mkdir(parents=True, exist_ok=True)
    if is_in_postgresql(course.db_url):
        postgresql.make_tables(course.db_url)
        return
    _refuse_gone(course)
    _refuse_emptied(course)
    if course.database.exists() and course.database.stat().st_size:
        return
    aside = course.database.with_name('.gradebook.db.new')
    for left in course.gradebook.glob(f'{aside.name}*'):  # left by a run that was killed
        left.unlink()
    _make_tables(f'sqlite:///{aside}')
    os.replace(aside, course.database)


def _refuse_gone(course: Course) -> None:
    if not course.database.exists() and failures.newest_backup(course):
        raise GradebookError(failures.gone_message(course))


def _refuse_emptied(course: Course) -> None:
    """Raise GradebookError if the file lost its content: a new database would have no scores."""
    if not course.database.exists() or course.database.stat().st_size:
        return
    graded = course.folder('autograded', '', '').glob('*/*/*.ipynb')
    if failures.newest_backup(course) or any(graded):
        raise GradebookError(failures.damaged_message(course, 'the file is empty'))


def _make_tables(db_url: str) -> None:
    """Make nbgrader's tables, and record the version of its schema.

    To find that version, nbgrader would start `alembic`, which takes a second.
    """
    from alembic.runtime.migration import MigrationContext
    from alembic.script import ScriptDirectory

    engine = create_engine(db_url)
    Base.metadata.create_all(engine)
    with engine.begin() as connection:
        MigrationContext.configure(connection).stamp(ScriptDirectory(ALEMBIC_DIR), 'heads')
    engine.dispose()
    Gradebook(db_url).close()  # adds nbgrader's row of the course


def wait_until_free(course: Course, say: Callable[[str], None] = print_at_once) -> None:
    """Wait while another program locks the database, and say so. Raises after TIMEOUT_SEC.

    PostgreSQL serves several programs at a time: wait until its server answers.
    """
    if is_in_postgresql(course.db_url):
        postgresql.wait_until_available(course.db_url, failures.TIMEOUT_SEC, say)
        return
    _refuse_gone(course)
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
"""By URL: the open engine of each block of `share_engine`; None until the first use."""


@contextmanager
def share_engine(db_url: str) -> Iterator[None]:
    """Let `open_database` create this engine only once: that costs most of its time.

    The file is still opened anew each time. The outermost block ends the reuse.
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
"""By URL: the databases that are open now."""


@contextmanager
def open_database(db_url: str) -> Iterator[Gradebook]:
    """Open the database; what is not committed at the end is discarded.

    A block inside another one uses the same connection; its end discards loaded objects, too.
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
        with book:  # closes its connections, which it makes again when needed
            yield book
    finally:
        del _connected[db_url]


@contextmanager
def transaction(db_url: str) -> Iterator[Gradebook]:
    """Open the database; commit once at the end what nbgrader would commit cell by cell."""
    with open_database(db_url) as book:
        commit, book.db.commit = book.db.commit, book.db.flush
        try:
            yield book
            commit()
        finally:
            book.db.commit = commit
