"""Write due dates and extensions into nbgrader's database, and correct late penalties."""

from collections.abc import Iterator
from datetime import datetime, timedelta
from pathlib import Path

from nbgrader.api import Assignment, Grade, Gradebook, SubmittedAssignment, SubmittedNotebook
from sqlalchemy import bindparam, func, or_, select
from sqlalchemy.orm import contains_eager, joinedload

from grader.course import Course
from grader.storage.database import open_database
from grader.storage.deadlines import Deadlines, deadlines
from grader.storage.lock import gradebook_lock

_SUBMISSION = (
    select(SubmittedAssignment)
    .join(SubmittedAssignment.assignment)
    .options(
        contains_eager(SubmittedAssignment.assignment), joinedload(SubmittedAssignment.notebooks)
    )
    .where(
        Assignment.name == bindparam('assignment'),
        SubmittedAssignment.student_id == bindparam('student'),
    )
)
"""A submission with all that decides whether it is late, in one query."""
_LATE = (
    select(SubmittedAssignment)
    .join(SubmittedAssignment.assignment)
    .options(
        contains_eager(SubmittedAssignment.assignment),
        joinedload(SubmittedAssignment.notebooks),
    )
    .where(
        or_(
            SubmittedAssignment.timestamp > Assignment.duedate,
            SubmittedAssignment.id.in_(
                select(SubmittedNotebook.assignment_id).where(
                    SubmittedNotebook.late_submission_penalty > 0
                )
            ),
        )
    )
)
"""Submissions that are past the due date or have a penalty, including extended ones.

One query finds them all, and another one all scores: nbgrader's tables have no index to ask this
for each submission.
"""
_SCORES = select(Grade.notebook_id, func.sum(Grade.score)).group_by(Grade.notebook_id)
_EXTENDED = (
    select(SubmittedAssignment)
    .join(SubmittedAssignment.assignment)
    .options(contains_eager(SubmittedAssignment.assignment))
    .where(
        or_(
            SubmittedAssignment.extension.is_not(None),
            SubmittedAssignment.student_id.in_(bindparam('extended', expanding=True)),
        )
    )
)
"""Submissions with an extension, in the database or in the file."""


def store_due_date(gradebook: Path, db_url: str, assignment: str, student_id: str) -> bool:
    """Store a submission's due date; return whether it is late, or has a late penalty."""
    found = deadlines(gradebook)
    with open_database(db_url) as book:
        whose = {'assignment': assignment, 'student': student_id}
        submission = book.db.execute(_SUBMISSION, whose).unique().scalar_one()
        if found:  # without a file, the dates that nbgrader was given stay
            submission.assignment.duedate = found.due.get(assignment)
            submission.extension = found.extension(assignment, student_id)
            book.db.commit()
        was_late = any(each.late_submission_penalty for each in submission.notebooks)
        return was_late or submission.total_seconds_late > 0


def recount_late_penalties(course: Course) -> None:
    """Correct late penalties for today's dates, rules and manual scores.

    nbgrader computes them only when it grades. If there is no file, the dates that nbgrader was
    given stay.
    """
    found = deadlines(course.gradebook)
    with open_database(course.db_url) as book:
        if not any(_changed_dates(book, found)) and not any(_wrong_penalties(book, found)):
            return
    with gradebook_lock(course.gradebook), open_database(course.db_url) as book:
        for row, column, when in [*_changed_dates(book, found)]:
            setattr(row, column, when)
        book.db.flush()  # before the query for late submissions
        for notebook, penalty in _wrong_penalties(book, found):
            notebook.late_submission_penalty = penalty
        book.db.commit()


def _changed_dates(
    book: Gradebook, found: Deadlines | None
) -> Iterator[tuple[Assignment | SubmittedAssignment, str, datetime | timedelta | None]]:
    """Yield what differs from the file's dates: the row, its column, and the file's date."""
    if not found:
        return
    for assignment in book.assignments:
        if assignment.duedate != (due := found.due.get(assignment.name)):
            yield assignment, 'duedate', due
    extended = sorted({student for _, student in found.extended})
    for submission in book.db.execute(_EXTENDED, {'extended': extended}).scalars().all():
        extension = found.extension(submission.assignment.name, submission.student_id)
        if submission.extension != extension:
            yield submission, 'extension', extension


def _wrong_penalties(
    book: Gradebook, found: Deadlines | None
) -> Iterator[tuple[SubmittedNotebook, float | None]]:
    """Yield notebooks whose penalty is wrong for their score, and the right penalty."""
    rules = found or Deadlines()
    found_late = book.db.execute(_LATE).unique().scalars().all()
    scores = dict(book.db.execute(_SCORES).all()) if found_late else {}
    for late in found_late:
        for notebook in late.notebooks:
            score = scores.get(notebook.id, 0.0)
            penalty = rules.penalty(score, late.total_seconds_late)
            if penalty is not None:
                penalty = min(penalty, score)
            if penalty != notebook.late_submission_penalty:
                yield notebook, penalty
