"""The database in PostgreSQL: create it, wait for it, and explain its errors in sentences."""

import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from nbgrader.api import Base, Course
from nbgrader.dbutil import ALEMBIC_DIR
from sqlalchemy import URL, Connection, NullPool, create_engine, make_url, text
from sqlalchemy.exc import DBAPIError

from grader.common.db_url import FILE
from grader.common.errors import GradebookError

AGAIN = 'then run the same command again: it goes on'
_MAKE = (
    'Make one, as the administrator: createdb --owner=USER --encoding=UTF8 --template=template0 '
    f'{{name}}; {AGAIN}.'
)
ADDRESS = f'gradebook/{FILE}'
_MAKING = 20_26
"""The key of PostgreSQL's advisory lock for making tables: one process at a time makes them."""


@dataclass(frozen=True)
class _Fault:
    """A kind of error that PostgreSQL reports, and the message for it."""

    states: tuple[str, ...]
    """Beginnings of its SQLSTATE; psycopg has no SQLSTATE if a connection was refused."""
    words: str
    """Without a SQLSTATE: a pattern of its English text; else the fault counts as _AWAY."""
    sentence: str


_FAULTS = (
    _Fault(
        ('3D000',),
        r'database ".*" does not exist',
        f'{{where}} does not exist on that server. {_MAKE}',
    ),
    _Fault(
        ('28',),
        r'password|authentication|pg_hba\.conf|role ".*" (does not exist|is not permitted)',
        '{where} refuses the login ({cause}). Correct the user or the password in '
        f'{ADDRESS} or in ~/.pgpass, {AGAIN}',
    ),
    _Fault(
        ('42501', '25006'),
        'permission denied',
        '{where} refuses to be written to ({cause}). Let its user own it, as the administrator: '
        'ALTER DATABASE "{name}" OWNER TO USER, and its tables (docs/postgresql.md, Rights); '
        + AGAIN,
    ),
    _Fault(
        ('53100', '53200'),
        'No space left',
        'the server of {where} has no room left ({cause}). What was stored before is kept. '
        f'Free some there, {AGAIN}',
    ),
    _Fault(
        ('53300',),
        'too many (clients|connections)|connection slots are reserved',
        '{where} takes no more connections ({cause}). Close programs that use it, or raise '
        f'max_connections there, {AGAIN}',
    ),
    _Fault(
        ('55P03',),
        'lock timeout',
        'another program has kept {where} locked for too long ({cause}). What was stored before '
        f'is kept. Close what has it open (psql, a formgrader that hangs), {AGAIN}',
    ),
)
_AWAY = _Fault(
    ('08', '57P'),
    '',
    '{where} does not answer ({cause}). What was stored before is kept. Start the server, or '
    f'correct {ADDRESS}, {AGAIN}',
)


def has_tables(db_url: str) -> bool:
    """Whether nbgrader's tables exist, all of them."""
    with _connection(db_url) as connection:
        return _has_tables(connection)


def make_tables(db_url: str) -> None:
    """Make nbgrader's tables if there are none, all of them in one transaction."""
    from alembic.runtime.migration import MigrationContext
    from alembic.script import ScriptDirectory

    with _connection(db_url) as connection:
        if _has_tables(connection):
            return
        encoding = connection.execute(text('SHOW server_encoding')).scalar()
        if encoding != 'UTF8':
            raise GradebookError(
                f'{url_to_show(db_url)} has the encoding {encoding}, in which not every name '
                f'can be written. {_MAKE.format(name=make_url(db_url).database)}'
            )
        connection.execute(text(f'SELECT pg_advisory_xact_lock({_MAKING})'))
        if _has_tables(connection):  # another process has made them while this one waited
            return
        Base.metadata.create_all(connection)
        MigrationContext.configure(connection).stamp(ScriptDirectory(ALEMBIC_DIR), 'heads')
        if connection.execute(text("SELECT 1 FROM course WHERE id = 'default_course'")).first():
            return
        connection.execute(Course.__table__.insert().values(id='default_course'))


def wait_until_available(db_url: str, timeout_sec: float, say: Callable[[str], None]) -> None:
    """Wait while the server does not answer, for example during a restart, and say so.

    Raises the connection's error after `timeout_sec`, or at once if waiting can't help.
    """
    deadline, said = time.monotonic() + timeout_sec, False
    while True:
        try:
            with _connection(db_url):
                return
        except DBAPIError as error:
            if _fault_of(error) is not _AWAY or time.monotonic() > deadline:
                raise
            if not said:
                say(f'waiting: {url_to_show(db_url)} does not answer ({_cause(error, db_url)})')
                said = True
        time.sleep(0.2)


def message_of(error: BaseException, db_url: str) -> str | None:
    """Return the message for an error, or None if it does not come from the database."""
    if isinstance(error, ModuleNotFoundError) and error.name == 'psycopg':
        return (
            f'{url_to_show(db_url)} needs psycopg, which this Python lacks: install it with '
            '.venv/bin/python -m pip install -r environment.txt'
        )
    if not isinstance(error, DBAPIError) or not (fault := _fault_of(error)):
        return None
    return (
        fault.sentence.format(
            where=url_to_show(db_url), name=make_url(db_url).database, cause=_cause(error, db_url)
        ).rstrip('.')
        + '.'
    )


def state_of(db_url: str) -> str:
    """Return a text that changes with every write to the database."""
    query = """SELECT system_identifier, oid, pg_current_snapshot()
        FROM pg_control_system(), pg_database WHERE datname = current_database()"""
    with _connection(db_url) as connection:
        return ' '.join(map(str, connection.execute(text(query)).one()))


def url_to_show(db_url: str) -> str:
    """Return a database's URL as it may be shown: without the password."""
    url = make_url(db_url)
    shorter = URL.create(
        'postgresql', url.username, None, url.host, url.port, url.database, url.query and {}
    )
    return shorter.render_as_string()


@contextmanager
def _connection(db_url: str) -> Iterator[Connection]:
    """Connect for one transaction, which is committed at the end of the block."""
    engine = create_engine(db_url, poolclass=NullPool)
    with engine.begin() as connection:
        yield connection


def _has_tables(connection: Connection) -> bool:
    there = connection.execute(text("SELECT to_regclass('alembic_version')")).scalar() is not None
    if there:  # raises if the tables belong to another user and can't be read
        connection.execute(text('SELECT 1 FROM alembic_version'))
    return there


def _fault_of(error: DBAPIError) -> _Fault | None:
    """Return the kind of fault of a database error; None if it is a fault in our own code."""
    state = getattr(error.orig, 'sqlstate', None) or ''
    said = str(error.orig)
    for fault in _FAULTS:
        if state.startswith(fault.states) if state else re.search(fault.words, said):
            return fault
    lost = error.connection_invalidated or type(error.orig).__name__ == 'OperationalError'
    return _AWAY if state.startswith(_AWAY.states) or (not state and lost) else None


def _cause(error: DBAPIError, db_url: str) -> str:
    """Return the server's message in one line, without the password in case it contains it."""
    lines = [line.strip(' -\t') for line in str(error.orig).splitlines() if line.strip()]
    first = next((line for line in lines if 'FATAL' in line), lines[0] if lines else 'no reason')
    said = re.sub(r'^.*\bfailed: (FATAL: +)?', '', first).rstrip('.')
    password = make_url(db_url).password
    return said.replace(str(password), '***') if password else said
