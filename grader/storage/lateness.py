"""Tell nbgrader's database what is due when."""

from datetime import timedelta
from pathlib import Path

from grader.storage.database import connected
from grader.storage.deadlines import deadlines


def tell_what_is_due(gradebook: Path, db_url: str, assignment: str, student_id: str) -> bool:
    """Write a submission's due date down; return whether lateness costs, or has cost, anything."""
    found = deadlines(gradebook)
    with connected(db_url) as book:
        submission = book.find_submission(assignment, student_id)
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
