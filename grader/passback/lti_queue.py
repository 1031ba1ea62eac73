"""The scores that a platform has, or is still to get, in a table that survives a crash.

A score waits from its change until the platform has confirmed it. Each try is recorded before the
score is sent: so a lost answer can be distinguished from a refused score.
"""

import sqlite3
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import astuple, dataclass, fields
from pathlib import Path

FILE = 'lti.db'


@dataclass(frozen=True)
class Score:
    """A student's score in an assignment, for the platform."""

    student_id: str
    assignment: str
    user_id: str
    score: float
    max_score: float
    changed: float
    """When the score changed, in Unix time; the platform keeps the newest one."""
    tried: bool = False
    """Whether it was sent before without an answer."""
    problem: str = ''
    """Why it was not taken at the last try."""


_COLUMNS = tuple(field.name for field in fields(Score))
_SCHEMA = f"""
    CREATE TABLE IF NOT EXISTS scores (
        {', '.join(_COLUMNS)}, sent INTEGER NOT NULL DEFAULT 0,
        PRIMARY KEY (student_id, assignment));
"""
_OF = 'WHERE student_id = ? AND assignment = ? AND changed = ?'


class LtiQueue:
    """The table of one gradebook."""

    def __init__(self, database: sqlite3.Connection) -> None:
        self._database = database

    def note(self, scores: Iterable[Score]) -> None:
        """Queue those scores that have changed; a change replaces an earlier one.

        The time of each change is later than that of the previous one, even if the clock was set
        back.
        """
        with self._database:
            for each in scores:
                found = self._database.execute(
                    'SELECT user_id, score, max_score, changed FROM scores '
                    'WHERE student_id = ? AND assignment = ?',
                    (each.student_id, each.assignment),
                ).fetchone()
                if found and found[:3] == (each.user_id, each.score, each.max_score):
                    continue
                changed = max(each.changed, found[3] + 0.001) if found else each.changed
                row = (*astuple(each)[:5], changed, False, '', 0)
                self._database.execute(f'REPLACE INTO scores VALUES ({_marks(row)})', row)

    def waiting(self, assignment: str = '') -> list[Score]:
        """Return the scores that the platform does not have yet, the oldest change first."""
        rows = self._database.execute(
            f'SELECT {", ".join(_COLUMNS)} FROM scores WHERE NOT sent AND ? IN ("", assignment) '
            'ORDER BY changed, student_id',
            (assignment,),
        )
        return [Score(*row) for row in rows]

    def note_try(self, score: Score) -> None:
        """Record that a score is about to be sent."""
        self._set(score, 'tried = 1')

    def note_sent(self, score: Score) -> None:
        """Record that the platform has a score, unless the score has changed since."""
        self._set(score, "sent = 1, tried = 0, problem = ''")

    def note_problem(self, score: Score, problem: str, *, answered: bool) -> None:
        """Record why a score still waits; `answered` if the platform itself refused it."""
        self._set(score, f'problem = ?{", tried = 0" if answered else ""}', problem)

    def _set(self, score: Score, assigned: str, *values: str) -> None:
        with self._database:
            self._database.execute(
                f'UPDATE scores SET {assigned} {_OF}',
                (*values, score.student_id, score.assignment, score.changed),
            )


def _marks(row: tuple[object, ...]) -> str:
    return ', '.join('?' * len(row))


@contextmanager
def opened_lti_queue(gradebook: Path) -> Iterator[LtiQueue]:
    """Open the table of a gradebook; make it if there is none."""
    with closing(sqlite3.connect(gradebook / FILE, timeout=60)) as database:
        database.execute('PRAGMA synchronous = FULL')  # survives a power cut, too
        database.executescript(_SCHEMA)
        yield LtiQueue(database)
