"""What the database holds of a graded submission, in one or two queries."""

from dataclasses import dataclass

from nbgrader.api import (
    Assignment,
    BaseCell,
    Grade,
    Gradebook,
    Notebook,
    SubmittedAssignment,
    SubmittedNotebook,
)
from sqlalchemy import Select, bindparam, exists, select

from grader.common.points import sum_points


@dataclass(frozen=True)
class HeldScore:
    """The score of a submission."""

    score: float
    """With the late penalty subtracted."""
    max_score: float
    late: float
    """The late penalty, in points."""
    pending: bool
    """Whether a part of the score waits for manual grading."""


def _of_one_submission(asked: Select) -> Select:
    """Restrict a query on submitted notebooks to those of one submission."""
    return (
        asked.join(Notebook, Notebook.id == SubmittedNotebook.notebook_id)
        .join(SubmittedAssignment, SubmittedAssignment.id == SubmittedNotebook.assignment_id)
        .join(Assignment, Assignment.id == SubmittedAssignment.assignment_id)
        .where(
            Assignment.name == bindparam('assignment'),
            Notebook.name == bindparam('assignment'),
            SubmittedAssignment.student_id == bindparam('student'),
        )
    )


_PENDING = exists().where(
    Grade.notebook_id == SubmittedNotebook.id,
    Grade.auto_score.is_(None),
    Grade.manual_score.is_(None),
)
_SCORE = _of_one_submission(
    select(
        SubmittedNotebook.score,
        SubmittedNotebook.max_score,
        SubmittedNotebook.late_submission_penalty.label('late'),
        _PENDING.label('pending'),
    )
)
_AUTO_SCORES = _of_one_submission(
    select(BaseCell.name, Grade.auto_score)
    .join(BaseCell, BaseCell.id == Grade.cell_id)
    .join(SubmittedNotebook, SubmittedNotebook.id == Grade.notebook_id)
)
_MANUAL_SCORES = _of_one_submission(
    select(BaseCell.name, Grade.manual_score)
    .join(BaseCell, BaseCell.id == Grade.cell_id)
    .join(SubmittedNotebook, SubmittedNotebook.id == Grade.notebook_id)
    .where(Grade.manual_score.is_not(None))
)


def held_score(book: Gradebook, student_id: str, assignment: str) -> HeldScore | None:
    """Return the score of a submission; None if it is not graded."""
    whose = {'assignment': assignment, 'student': student_id}
    found = book.db.execute(_SCORE, whose).one_or_none()
    if found is None:
        return None
    late = found.late or 0.0
    return HeldScore(sum_points((found.score, -late)), found.max_score, late, bool(found.pending))


def auto_scores(book: Gradebook, student_id: str, assignment: str) -> dict[str, float | None]:
    """Return the automatic scores of a submission, by grade id; None for a cell without one."""
    whose = {'assignment': assignment, 'student': student_id}
    return dict(book.db.execute(_AUTO_SCORES, whose).all())


def manual_scores(book: Gradebook, student_id: str, assignment: str) -> dict[str, float]:
    """Return the points that a person has given in a submission, by grade id."""
    whose = {'assignment': assignment, 'student': student_id}
    return dict(book.db.execute(_MANUAL_SCORES, whose).all())
