"""Tell nbgrader's database what is due when."""

from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path

from nbgrader.api import Assignment, Gradebook, SubmittedAssignment, SubmittedNotebook
from sqlalchemy import bindparam, select
from sqlalchemy.orm import contains_eager, joinedload

from grader.course import Course
from grader.storage.database import connected
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
"""With all that tells whether it is late, in one question."""
_LATE = (
    select(SubmittedAssignment)
    .join(SubmittedAssignment.assignment)
    .options(
        contains_eager(SubmittedAssignment.assignment),
        joinedload(SubmittedAssignment.notebooks).undefer(SubmittedNotebook.score),
    )
    .where(SubmittedAssignment.timestamp > Assignment.duedate)
)
"""Those in time by an extension are among them."""


def tell_what_is_due(gradebook: Path, db_url: str, assignment: str, student_id: str) -> bool:
    """Write a submission's due date down; return whether lateness costs, or has cost, anything."""
    found = deadlines(gradebook)
    with connected(db_url) as book:
        whose = {'assignment': assignment, 'student': student_id}
        submission = book.db.execute(_SUBMISSION, whose).unique().scalar_one()
        if found:  # else whatever nbgrader was told stays
            due = found.due.get(assignment)
            extension = None
            if due:
                later = found.extended.get((assignment, student_id), due)
                extension = max(later - due, timedelta())
            submission.assignment.duedate = due
            submission.extension = extension or None
            book.db.commit()
        was_late = any(each.late_submission_penalty for each in submission.notebooks)
        return was_late or submission.total_seconds_late > 0


def recount_late_penalties(course: Course) -> None:
    """Take the share of what a person has given meanwhile, too: nbgrader counts at grading alone.

    Dates stay those of the latest grading.
    """
    rules = deadlines(course.gradebook) or Deadlines()
    with connected(course.db_url) as book:
        if not any(_outdated(book, rules)):
            return
    with gradebook_lock(course.gradebook), connected(course.db_url) as book:
        for notebook, penalty in _outdated(book, rules):
            notebook.late_submission_penalty = penalty
        book.db.commit()


def _outdated(
    book: Gradebook, rules: Deadlines
) -> Iterator[tuple[SubmittedNotebook, float | None]]:
    """Find late notebooks whose penalty is not that of their score, and what it should be."""
    for late in book.db.execute(_LATE).unique().scalars().all():
        if late.total_seconds_late <= 0:
            continue
        for notebook in late.notebooks:
            penalty = rules.penalty(notebook.score, late.total_seconds_late)
            if penalty is not None:
                penalty = min(penalty, notebook.score)
            if penalty != notebook.late_submission_penalty:
                yield notebook, penalty
