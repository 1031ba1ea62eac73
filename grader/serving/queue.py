"""What was handed in and what became of it: a table that survives the end of any process."""

import sqlite3
from collections.abc import Iterable, Mapping
from dataclasses import astuple, dataclass, fields, replace

from grader.common.text import storable

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


COLUMNS = tuple(field.name for field in fields(Arrival))


class Queue:
    """The table of one gradebook; one process writes into it, and any number read.

    Who writes takes in from one inbound folder: what is said of entries of others stays as it is.
    """

    def __init__(self, database: sqlite3.Connection, inbound: str = '') -> None:
        self._database = database
        self._inbound = inbound

    def seen(self) -> dict[str, str]:
        """Return the fingerprint of each entry that was looked into: the folder's own counts most.

        One of another folder is of use if both are the same, mounted twice.
        """
        return dict(
            self._database.execute(
                'SELECT entry, fingerprint FROM looked_into ORDER BY inbound = ?', (self._inbound,)
            )
        )

    def refused_entries(self) -> set[str]:
        """Return the entries of the folder of which something is refused that is nobody's."""
        rows = self._database.execute(
            "SELECT entry FROM arrivals WHERE inbound = ? AND state = ? AND student_id = ''",
            (self._inbound, REFUSED),
        )
        return {entry for (entry,) in rows}

    def add(self, entry: str, fingerprint: str, arrivals: Iterable[Arrival]) -> list[Arrival]:
        """Note what an entry held, all of it or nothing; return it with its numbers.

        What was said of it as a whole before, when it held something else, is said no more.
        """
        added = []
        with self._database:
            self._withdraw(entry)
            for each in arrivals:
                marks = ', '.join('?' * len(COLUMNS))
                cursor = self._database.execute(
                    f'INSERT INTO arrivals ({", ".join(COLUMNS[1:])}, inbound) VALUES ({marks})',
                    (*_values(each), self._inbound),
                )
                added.append(replace(each, number=cursor.lastrowid or 0))
            self._database.execute(
                'REPLACE INTO looked_into VALUES (?, ?, ?)', (self._inbound, entry, fingerprint)
            )
        return added

    def forget(self, entry: str) -> bool:
        """Say no more of an entry as a whole; return whether it is new, should it come back.

        One of which submissions were taken in is not: they would be handed in once more.
        """
        with self._database:
            self._withdraw(entry)
            forgotten = self._database.execute(
                'DELETE FROM looked_into WHERE inbound = :inbound AND entry = :entry'
                ' AND NOT EXISTS'
                ' (SELECT 1 FROM arrivals WHERE inbound = :inbound AND entry = :entry)',
                {'inbound': self._inbound, 'entry': entry},
            )
        return forgotten.rowcount > 0

    def _withdraw(self, entry: str) -> None:
        self._database.execute(
            'DELETE FROM arrivals WHERE inbound = ? AND entry = ? AND state = ?'
            " AND student_id = ''",
            (self._inbound, entry, REFUSED),
        )

    def update(self, *arrivals: Arrival) -> None:
        """Note what has become of arrivals, of all of them or of none."""
        assigned = ', '.join(f'{name} = ?' for name in COLUMNS[1:])
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
            f'SELECT {", ".join(COLUMNS)} FROM arrivals WHERE state IN ({marks}) '
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
