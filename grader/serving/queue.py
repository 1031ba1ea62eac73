"""What was handed in and what became of it: a table that survives the end of any process."""

import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

from grader.common.text import storable

FILE = 'serve.db'
WAITING, GRADING, GRADED = 'waiting', 'grading', 'graded'
KEEPING, REPLACED, REFUSED, FAILED = 'being kept', 'replaced', 'refused', 'failed'
"""What became of an arrival; what is refused or has failed waits for a person.

What is `being kept` is not graded, for a later one is, and is yet to be put beside that.
"""


@dataclass(frozen=True)
class Arrival:
    """One submission as it came in, or an entry that is nobody's."""

    number: int
    entry: str
    """Its name in the inbound folder, strange bytes in it spelled out."""
    arrived: float
    """In seconds since 1970; no claim of whoever handed it in."""
    state: str
    student_id: str = ''
    assignment: str = ''
    folder: str = ''
    """Where its files lie until they are graded, by its name in gradebook/arrived/."""
    reason: str = ''
    """Why it was refused, has failed or was replaced."""
    started: float = 0.0
    ended: float = 0.0
    score: float | None = None
    max_score: float | None = None

    @property
    def whose(self) -> tuple[str, str]:
        """Return the student and the assignment."""
        return self.student_id, self.assignment


_COLUMNS = tuple(field.name for field in fields(Arrival))
_SCHEMA = f"""
    CREATE TABLE IF NOT EXISTS seen (entry TEXT PRIMARY KEY, fingerprint TEXT NOT NULL);
    CREATE TABLE IF NOT EXISTS arrivals (
        number INTEGER PRIMARY KEY AUTOINCREMENT, {', '.join(_COLUMNS[1:])});
    CREATE INDEX IF NOT EXISTS states ON arrivals (state);
    CREATE INDEX IF NOT EXISTS entries ON arrivals (entry);
    CREATE INDEX IF NOT EXISTS students ON arrivals (student_id, assignment);
"""


class Queue:
    """The table of one gradebook; one process writes into it, and any number read."""

    def __init__(self, database: sqlite3.Connection) -> None:
        self._database = database

    def seen(self) -> dict[str, str]:
        """Return the fingerprint of each entry that was looked into."""
        return dict(self._database.execute('SELECT entry, fingerprint FROM seen'))

    def add(self, entry: str, fingerprint: str, arrivals: Iterable[Arrival]) -> list[Arrival]:
        """Note what an entry held, all of it or nothing; return it with its numbers.

        What was said of it as a whole before, when it held something else, is said no more.
        """
        added = []
        with self._database:
            self._withdraw(entry)
            for each in arrivals:
                marks = ', '.join('?' * (len(_COLUMNS) - 1))
                cursor = self._database.execute(
                    f'INSERT INTO arrivals ({", ".join(_COLUMNS[1:])}) VALUES ({marks})',
                    _values(each),
                )
                added.append(replace(each, number=cursor.lastrowid or 0))
            self._database.execute('REPLACE INTO seen VALUES (?, ?)', (entry, fingerprint))
        return added

    def forget(self, entry: str) -> bool:
        """Say no more of an entry as a whole; return whether it is new, should it come back.

        One of which submissions were taken in is not: they would be handed in once more.
        """
        with self._database:
            self._withdraw(entry)
            forgotten = self._database.execute(
                'DELETE FROM seen WHERE entry = :entry'
                ' AND NOT EXISTS (SELECT 1 FROM arrivals WHERE entry = :entry)',
                {'entry': entry},
            )
        return forgotten.rowcount > 0

    def _withdraw(self, entry: str) -> None:
        self._database.execute(
            "DELETE FROM arrivals WHERE entry = ? AND state = ? AND student_id = ''",
            (entry, REFUSED),
        )

    def update(self, *arrivals: Arrival) -> None:
        """Note what has become of arrivals, of all of them or of none."""
        assigned = ', '.join(f'{name} = ?' for name in _COLUMNS[1:])
        with self._database:
            self._database.executemany(
                f'UPDATE arrivals SET {assigned} WHERE number = ?',
                [(*_values(each), each.number) for each in arrivals],
            )

    def resume(self) -> None:
        """Let what was being graded when a process ended wait again."""
        with self._database:
            self._database.execute(
                'UPDATE arrivals SET state = ? WHERE state = ?', (WAITING, GRADING)
            )

    def find(self, *states: str, last: int | None = None) -> list[Arrival]:
        """Return the arrivals in some states, in their order; perhaps only the `last` ones."""
        marks = ', '.join('?' * len(states))
        rows = self._database.execute(
            f'SELECT {", ".join(_COLUMNS)} FROM arrivals WHERE state IN ({marks}) '
            'ORDER BY number DESC LIMIT ?',
            (*states, -1 if last is None else last),
        )
        return [Arrival(*row) for row in rows][::-1]

    def counts(self) -> Mapping[str, int]:
        """Return how many arrivals are in each state."""
        return dict(self._database.execute('SELECT state, count(*) FROM arrivals GROUP BY state'))

    def starts(self) -> dict[tuple[str, str], list[float]]:
        """Return when submissions of each student and assignment were graded, in their order."""
        found: dict[tuple[str, str], list[float]] = {}
        rows = self._database.execute(
            'SELECT student_id, assignment, started FROM arrivals WHERE state IN (?, ?) '
            'ORDER BY started',
            (GRADING, GRADED),
        )
        for student, assignment, started in rows:
            found.setdefault((student, assignment), []).append(started)
        return found


def _values(arrival: Arrival) -> list[object]:
    """Return what a row holds: text of strangers, in names and reasons, is made storable."""
    return [storable(each) if isinstance(each, str) else each for each in astuple(arrival)[1:]]


@contextmanager
def opened_queue(gradebook: Path) -> Iterator[Queue]:
    """Open the queue of a gradebook; make it where there is none."""
    gradebook.mkdir(parents=True, exist_ok=True)
    with closing(sqlite3.connect(gradebook / FILE, timeout=60)) as database:
        database.execute('PRAGMA synchronous = FULL')  # after a power cut, too
        database.executescript(_SCHEMA)
        yield Queue(database)


@contextmanager
def queue_to_read(gradebook: Path) -> Iterator[Queue | None]:
    """Open the queue of a gradebook to look at it alone; None where there is none."""
    if not (gradebook / FILE).exists():
        yield None
        return
    address = f'{(gradebook / FILE).resolve().as_uri()}?mode=ro'
    with closing(sqlite3.connect(address, uri=True, timeout=60)) as database:
        yield Queue(database)
