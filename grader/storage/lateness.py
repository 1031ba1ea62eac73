"""Tell nbgrader's database what is due when."""

from datetime import timedelta
from pathlib import Path

from nbgrader.api import Assignment, SubmittedAssignment
from sqlalchemy import bindparam, select
from sqlalchemy.orm import contains_eager, joinedload

from grader.storage.database import connected
from grader.storage.deadlines import deadlines

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
