"""The queue: what was handed in and what became of it, in a table that survives a restart."""

import sqlite3
from collections.abc import Iterable, Mapping
from dataclasses import astuple, dataclass, fields, replace

from grader.common.text import printable, storable

WAITING, GRADING, GRADED = 'waiting', 'grading', 'graded'
KEEPING, REPLACED, REFUSED, FAILED = 'being kept', 'replaced', 'refused', 'failed'
UNDECIDED = 'undecided'
"""States of an arrival; a person has to look at one that is refused or has failed.

One `being kept` is not graded, because a later one is; it has yet to be stored beside that one.
In an `undecided` one, a check could not decide: it is graded once more when there is time.
"""


@dataclass(frozen=True)
class Arrival:
    """One submission as it came in, or an entry that does not belong to a student."""

    number: int
    entry: str
    """Its name in the inbound folder, with bytes that are not UTF-8 escaped."""
    arrived: float
    """In Unix time, from the file system: a student can't choose it."""
    state: str
    student_id: str = ''
    assignment: str = ''
    folder: str = ''
    """The name of the folder in gradebook/arrived/ with its files, until they are graded."""
    reason: str = ''
    """Why it was refused, failed or was replaced."""
    started: float = 0.0
    ended: float = 0.0
    score: float | None = None
    max_score: float | None = None

    @property
    def submission_key(self) -> tuple[str, str]:
        """Return the student and the assignment."""
        return self.student_id, self.assignment

    @property
    def printable_name(self) -> str:
        """Return how messages name a submission."""
        return printable(f'{self.assignment} of {self.student_id}')


COLUMNS = tuple(field.name for field in fields(Arrival))


class Queue:
    """The table of one gradebook; one process writes into it, and any number read it.

    The writer serves one inbound folder, and does not change rows of entries in other folders.
    """

    def __init__(self, database: sqlite3.Connection, inbound: str = '') -> None:
        self._database = database
        self._inbound = inbound

    def seen(self) -> dict[str, str]:
        """Return the fingerprint of each known entry; those in the own folder take precedence.

        Those of another folder are useful if both are the same folder, mounted twice.
        """
        return dict(
            self._database.execute(
                'SELECT entry, fingerprint FROM looked_into ORDER BY inbound = ?', (self._inbound,)
            )
        )

    def refused_entries(self) -> set[str]:
        """Return the names of refused entries in the folder that do not belong to a student."""
        rows = self._database.execute(
            "SELECT entry FROM arrivals WHERE inbound = ? AND state = ? AND student_id = ''",
            (self._inbound, REFUSED),
        )
        return {entry for (entry,) in rows}

    def add(self, entry: str, fingerprint: str, arrivals: Iterable[Arrival]) -> list[Arrival]:
        """Record what an entry contained, all of it or nothing; return it with its row numbers.

        An earlier refusal of the whole entry, when it had other content, is removed.
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
        """Remove the refusal of an entry; return whether it would be read again if it came back.

        It would not be if submissions were taken from it: they would be handed in twice.
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
        """Store the new states of arrivals, of all of them or of none."""
        assigned = ', '.join(f'{name} = ?' for name in COLUMNS[1:])
        with self._database:
            self._database.executemany(
                f'UPDATE arrivals SET {assigned} WHERE number = ?',
                [(*_values(each), each.number) for each in arrivals],
            )

    def resume(self) -> None:
        """Let submissions whose grading was interrupted wait again."""
        with self._database:
            self._database.execute(
                'UPDATE arrivals SET state = ? WHERE state = ?', (WAITING, GRADING)
            )

    def find(self, *states: str, last: int | None = None) -> list[Arrival]:
        """Return the arrivals in these states, in order; `last` limits them to the newest ones."""
        marks = ', '.join('?' * len(states))
        rows = self._database.execute(
            f'SELECT {", ".join(COLUMNS)} FROM arrivals WHERE state IN ({marks}) '
            'ORDER BY number DESC LIMIT ?',
            (*states, -1 if last is None else last),
        )
        return [Arrival(*row) for row in rows][::-1]

    def counts(self) -> Mapping[str, int]:
        """Return the number of arrivals in each state."""
        return dict(self._database.execute('SELECT state, count(*) FROM arrivals GROUP BY state'))

    def starts(self) -> dict[tuple[str, str], list[float]]:
        """Return when gradings of each student and assignment started, in order."""
        found: dict[tuple[str, str], list[float]] = {}
        rows = self._database.execute(
            'SELECT student_id, assignment, started FROM arrivals WHERE state IN (?, ?, ?) '
            'ORDER BY started',
            (GRADING, GRADED, UNDECIDED),
        )
        for student, assignment, started in rows:
            found.setdefault((student, assignment), []).append(started)
        return found


def _values(arrival: Arrival) -> list[object]:
    """Return the columns of a row; text of students, in names and reasons, is made storable."""
    return [storable(each) if isinstance(each, str) else each for each in astuple(arrival)[1:]]
