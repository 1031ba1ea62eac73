"""Read a table that a course platform exported, and find the row of each student."""

import csv
import io
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from grader.common.errors import CourseError
from grader.common.student_names import same_person
from grader.common.text import shorten

MAX_BYTES = 20_000_000
MOST_NAMED, MOST_COLUMNS = 20, 60
"""How many headings a message names, and how much of each, in columns of a terminal."""


@dataclass(frozen=True)
class Roster:
    """A table with a line of headings."""

    path: Path
    headings: tuple[str, ...]
    rows: tuple[Mapping[str, str], ...]


def read_roster(path: Path, needed: Iterable[str], how: str) -> Roster:
    """Read a CSV table, separated by commas or semicolons.

    Raises CourseError if it is not one or lacks a column; `how` says how to get the right file.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise CourseError(f'{path} cannot be read: {error.strerror}. {how}') from None
    if len(raw) > MAX_BYTES:
        raise CourseError(f'{path} has {len(raw):,} bytes: no roster is that long. {how}')
    try:
        text = raw.decode('utf-8-sig')
        first = text.partition('\n')[0]
        between = ';' if first.count(';') > first.count(',') else ','
        lines = list(csv.reader(io.StringIO(text, newline=''), delimiter=between, strict=True))
    except (UnicodeDecodeError, csv.Error):
        raise CourseError(f'{path} is not a CSV table in UTF-8. {how}') from None
    headings = tuple(heading.strip() for heading in lines[0]) if lines else ()
    lacks = [name for name in needed if name not in headings]
    if lacks:
        raise CourseError(
            f'{path} has no column {in_words(lacks)}. Found: {in_words(headings)}. {how}'
        )
    if len(set(headings)) < len(headings):
        raise CourseError(f'{path} has two columns of the same name. {how}')
    none = dict.fromkeys(headings, '')  # a line may end early: its other columns are empty
    rows = [none | dict(zip(headings, line, strict=False)) for line in lines[1:] if any(line)]
    return Roster(path, headings, tuple(rows))


def in_words(headings: Sequence[str]) -> str:
    """Return headings as text, of many only the first ones."""
    shown = ', '.join(repr(shorten(heading, MOST_COLUMNS)) for heading in headings[:MOST_NAMED])
    more = len(headings) - MOST_NAMED
    return f'{shown} and {more} more' if more > 0 else shown or 'none'


@dataclass(frozen=True)
class Matches:
    """The rows of students in a roster."""

    rows: Mapping[str, Mapping[str, str]]
    """By student ID."""
    unclear: tuple[str, ...]
    """For each student without a row, the reason."""


def match(
    students: Sequence[str],
    roster: Roster,
    *,
    number_of: Callable[[str], str | None],
    number_in: Callable[[Mapping[str, str]], str],
    name_of: Callable[[Mapping[str, str]], str],
    logins_in: Callable[[Mapping[str, str]], Collection[str]] = lambda row: (),
) -> Matches:
    """Find each student's row: that with the student's number on the platform, if it is known.

    Without a number it is the row with the student's login, else the only one with that name: a
    row with another number is another person's, or of another assignment. A row that may belong
    to two students is given to neither.
    """
    numbers = {student: number_of(student) for student in students}

    def rows_of(student: str) -> list[Mapping[str, str]]:
        if number := numbers[student]:
            return [row for row in roster.rows if number_in(row) == number]
        return [row for row in roster.rows if student in logins_in(row)] or [
            row for row in roster.rows if same_person(name_of(row), student)
        ]

    candidates = {student: rows_of(student) for student in students}
    taken = [id(row) for rows in candidates.values() if len(rows) == 1 for row in rows]
    found, unclear = {}, []
    for student, rows in candidates.items():
        if len(rows) == 1 and taken.count(id(rows[0])) == 1:
            found[student] = rows[0]
        elif not rows and numbers[student]:
            unclear.append(
                f'{student} has the number {numbers[student]}, which no row of {roster.path.name} '
                'has: expected the table of this course and assignment; export it again, or give '
                'this score by hand'
            )
        else:
            several = (
                'several rows' if len(rows) > 1 else 'a row that may also be of another student'
            )
            has = several if rows else 'no row'
            unclear.append(f'{student} has {has} in {roster.path.name}: give this score by hand')
    return Matches(found, tuple(unclear))
