"""Read gradebook/deadlines.toml; docs/for-instructors.md has an example."""

import math
import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

from grader.common.errors import CourseError
from grader.common.points import round_points
from grader.common.text import printable
from grader.course import Course
from grader.storage.resubmissions import ResubmissionRules, read_rules

FILE = 'deadlines.toml'
DAY_SEC = 86_400
_TABLES = {'due', 'extended', 'late', 'resubmissions'}
_POLICY = {'per_day': 1.0, 'at_most': 1.0, 'grace_minutes': math.inf}
"""The keys of [late], and the highest value of each."""


@dataclass(frozen=True)
class Deadlines:
    """What the file says; times in UTC, without a time zone, as nbgrader stores them."""

    due: Mapping[str, datetime] = field(default_factory=dict)
    extended: Mapping[tuple[str, str], datetime] = field(default_factory=dict)
    """By assignment and student ID."""
    per_day: float = 0.0
    at_most: float = 1.0
    grace_minutes: float = 0.0
    resubmissions: ResubmissionRules = field(default_factory=ResubmissionRules)

    def extension(self, assignment: str, student_id: str) -> timedelta | None:
        """Return how much later than others a student may hand in; None if not later."""
        due = self.due.get(assignment)
        until = self.extended.get((assignment, student_id))
        return until - due if due and until and until > due else None

    def penalty(self, score: float, seconds_late: float) -> float | None:
        """Return the points that lateness takes from a score; None if it takes nothing."""
        if not self.per_day or seconds_late <= 60 * self.grace_minutes:
            return None
        share = min(self.at_most, self.per_day * math.ceil(seconds_late / DAY_SEC))
        return round_points(score * share)


def deadlines(gradebook: Path, assignments: Collection[str] | None = None) -> Deadlines | None:
    """Read the file; return None if there is none.

    Raises CourseError if something in it is wrong, such as a name not among `assignments`.
    """
    path = gradebook / FILE
    if not path.exists():
        return None
    return read_deadlines(path.read_bytes(), path, assignments)


def read_deadlines(
    content: bytes, path: Path, assignments: Collection[str] | None = None
) -> Deadlines:
    """Read the content that the file at `path` has, or is going to have.

    Raises CourseError if something in it is wrong, such as a name not among `assignments`.
    """
    try:
        # Notepad begins a file with a byte order mark
        return _parse_deadlines(tomllib.loads(content.decode('utf-8-sig')), assignments)
    except (ValueError, _Wrong) as error:
        raise CourseError(
            f'{path}: {error}. Correct it: docs/for-instructors.md, Due dates, has an example.'
        ) from None


def extended_for_nobody(course: Course) -> list[str]:
    """Return a line for each extension of a student who has handed in nothing.

    The name may be misspelt: then another student lacks the extension.
    """
    found = deadlines(course.gradebook) or Deadlines()
    return [
        f'{FILE} extends {assignment} for {printable(student)}, who has not handed it in yet: '
        'check that the name is right'
        for assignment, student in sorted(found.extended)
        if not course.folder('submitted', student, assignment).is_dir()
    ]


class _Wrong(Exception):
    """What is wrong in the file."""


def _parse_deadlines(said: dict, assignments: Collection[str] | None) -> Deadlines:
    due, extended, late = (_table(said, name) for name in ('due', 'extended', 'late'))
    if strange := [*(said.keys() - _TABLES), *(late.keys() - _POLICY.keys())]:
        raise _Wrong(f'{strange[0]!r} is not a name that this file can have')
    for assignment in (*due, *extended):
        if assignments is not None and assignment not in assignments:
            raise _Wrong(f'there is no assignment {assignment!r}')
    for assignment in extended:
        if assignment not in due:
            raise _Wrong(f'{assignment} is in [extended], but has no date in [due]')
    for key, value in late.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise _Wrong(f'{key} must be a number')
        if not 0 <= value <= _POLICY[key]:
            most = f'0 to {_POLICY[key]:g}' if _POLICY[key] < math.inf else '0 or more'
            raise _Wrong(f'{key} = {value} is out of range: expected {most}')
    return Deadlines(
        due={assignment: _time(assignment, value) for assignment, value in due.items()},
        extended={
            (assignment, student): _time(f'{assignment} of {student}', value)
            for assignment in extended
            for student, value in _table(extended, assignment).items()
        },
        **late,
        resubmissions=read_rules(_table(said, 'resubmissions')),
    )


def _table(said: dict, name: str) -> dict:
    table = said.get(name, {})
    if not isinstance(table, dict):
        raise _Wrong(f'{name} must be a table, not a value')
    return table


def _time(what: str, value: object) -> datetime:
    if not isinstance(value, datetime) or value.tzinfo is None:
        raise _Wrong(
            f'{what} must have a date and a time with its zone, such as 2026-11-30T23:59:00+01:00'
        )
    return value.astimezone(UTC).replace(tzinfo=None)
