"""The file of a gradebook's queue: open it to serve, or only to read it."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from grader.common.text import storable
from grader.serving.queue import COLUMNS, Queue

FILE = 'serve.db'
_LOOKED_INTO = """CREATE TABLE IF NOT EXISTS looked_into (
        inbound TEXT, entry TEXT, fingerprint TEXT NOT NULL, PRIMARY KEY (inbound, entry))"""
_SCHEMA = f"""
    {_LOOKED_INTO};
    CREATE TABLE IF NOT EXISTS arrivals (
        number INTEGER PRIMARY KEY AUTOINCREMENT, {', '.join(COLUMNS[1:])}, inbound TEXT NOT NULL);
    CREATE INDEX IF NOT EXISTS states ON arrivals (state);
    CREATE INDEX IF NOT EXISTS entries ON arrivals (entry);
    CREATE INDEX IF NOT EXISTS students ON arrivals (student_id, assignment);
"""


@contextmanager
def open_queue(gradebook: Path, inbound: Path) -> Iterator[Queue]:
    """Open the queue of a gradebook for an inbound folder; make it if there is none."""
    gradebook.mkdir(parents=True, exist_ok=True)
    folder = storable(str(inbound.resolve()))
    with closing(sqlite3.connect(gradebook / FILE, timeout=60)) as database:
        database.execute('PRAGMA synchronous = FULL')  # survives a power cut, too
        _bring_up_to_date(database)
        database.executescript(_SCHEMA)
        _adopt(database, folder)
        yield Queue(database, folder)


def _bring_up_to_date(database: sqlite3.Connection) -> None:
    """Add the column for the inbound folder to tables of an earlier version."""
    if not list(database.execute("SELECT 1 FROM sqlite_schema WHERE name = 'seen'")):
        return
    with database:
        database.execute('BEGIN')
        database.execute("ALTER TABLE arrivals ADD COLUMN inbound TEXT NOT NULL DEFAULT ''")
        database.execute(_LOOKED_INTO)
        database.execute("INSERT INTO looked_into SELECT '', entry, fingerprint FROM seen")
        database.execute('DROP TABLE seen')


def _adopt(database: sqlite3.Connection, folder: str) -> None:
    """Assign rows of folders that no longer exist to this one: it was moved, or not recorded."""
    known = {each for (each,) in database.execute('SELECT inbound FROM looked_into')}
    with database:
        for gone in sorted(each for each in known if not each or not Path(each).is_dir()):
            for table in 'looked_into', 'arrivals':
                database.execute(
                    f'UPDATE OR REPLACE {table} SET inbound = ? WHERE inbound = ?', (folder, gone)
                )


@contextmanager
def open_queue_to_read(gradebook: Path) -> Iterator[Queue | None]:
    """Open the queue of a gradebook only to read it; None if there is none."""
    if not (gradebook / FILE).exists():
        yield None
        return
    address = f'{(gradebook / FILE).resolve().as_uri()}?mode=ro'
    with closing(sqlite3.connect(address, uri=True, timeout=60)) as database:
        yield Queue(database)
