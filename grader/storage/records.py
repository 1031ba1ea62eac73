"""What the gradebook and the executed notebooks say about each graded cell."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import nbformat
from nbformat import NotebookNode
from nbgrader.api import (
    Assignment,
    Comment,
    Grade,
    Gradebook,
    GradeCell,
    Notebook,
    Student,
    SubmittedAssignment,
    SubmittedNotebook,
)
from sqlalchemy import select
from sqlalchemy.orm import selectinload

from grader.common.errors import DamagedResult
from grader.course import Course
from grader.notebook.own_notebooks import parse_own_notebook
from grader.notebook.restore import KEY, grade_id
from grader.storage.database import open_database
from grader.storage.gradebook import needs_manual_grade, open_gradebook
from grader.storage.lesson_checksums import checksums
from grader.storage.registering import withdrawn_unseen

MOST_ASKED = 500
"""Students in one query: databases limit the number of values in a query."""


@dataclass(frozen=True)
class CellScore:
    """One graded cell of one student."""

    student_id: str
    assignment: str
    grade_id: str
    score: float | None
    """None if nothing was handed in, or if it waits for manual grading."""
    max_score: float
    submitted: bool = True
    by_hand: bool = False
    """Whether the score was given by hand."""
    comment: str = ''
    """The comment that was written by hand."""


def records(course: Course, *, only: Collection[tuple[str, str]] | None = None) -> list[CellScore]:
    """Return all graded cells of all students, in a stable order; registers new assignments.

    A lesson that is no longer in solutions/ is left out, unless a student has a score for it.
    `only` selects some graded submissions, as pairs of student and assignment.
    """
    with open_gradebook(course) if only is None else open_database(course.db_url) as book:
        cells_of = _cells_of(course, book, only)
        students = sorted(book.db.scalars(select(Student.id)))
        asked = {*only} if only is not None else {*product(students, cells_of)}
        found: dict[tuple[str, str], list[CellScore]] = {}
        for assignment, cells in cells_of.items():
            whose = [student for student in students if (student, assignment) in asked]
            graded = _stored_notebooks(book, assignment, whose)
            for student in whose:
                scores = _scores(student, assignment, cells, graded.get(student))
                found[student, assignment] = [*scores]
            book.db.expunge_all()  # free the rows of this assignment before the next one is read
        return [record for whose in sorted(found) for record in found[whose]]


def _cells_of(
    course: Course, book: Gradebook, only: Collection[tuple[str, str]] | None
) -> dict[str, list[GradeCell]]:
    """Return the graded cells of each requested assignment, in the lesson's order."""
    names = {name for [name] in book.db.execute(select(Assignment.name))}
    if only is None:
        names -= withdrawn_unseen(course, book)
    else:
        names &= {assignment for _, assignment in only}
    asked = (
        select(Assignment.name, GradeCell)
        .join(Notebook, GradeCell.notebook_id == Notebook.id)
        .join(Assignment, Notebook.assignment_id == Assignment.id)
        .where(Assignment.name.in_(sorted(names)))
    )
    found: dict[str, list[GradeCell]] = {name: [] for name in sorted(names)}
    for name, cell in book.db.execute(asked):
        found[name].append(cell)
    return {name: sorted(cells, key=_place_in(course, name)) for name, cells in found.items()}


def verdicts(course: Course, student_id: str, assignment: str) -> dict[str, dict]:
    """Return the verdict of each graded cell in a submission's executed notebook, by grade id."""
    return verdicts_in(graded_notebook(course, student_id, assignment))


def verdicts_in(graded: NotebookNode) -> dict[str, dict]:
    """Return the verdict of each graded cell in an executed notebook, by grade id."""
    return {name: cell.metadata.get(KEY, {}) for cell in graded.cells if (name := grade_id(cell))}


def graded_notebook(course: Course, student_id: str, assignment: str) -> NotebookNode:
    """Return the executed notebook of a submission; one without cells if there is none.

    Raises DamagedResult if the file is not a notebook.
    """
    path = course.folder('autograded', student_id, assignment) / f'{assignment}.ipynb'
    if not path.exists():
        return nbformat.v4.new_notebook()
    try:
        return parse_own_notebook(path.read_text('utf-8'))
    except ValueError:
        again = f'run ./course grade --student {student_id}, which grades it again'
        raise DamagedResult(f'the graded notebook {path} is damaged: {again}') from None


def _stored_notebooks(
    book: Gradebook, assignment: str, students: Sequence[str]
) -> dict[str, SubmittedNotebook]:
    """Return an assignment's stored notebooks by student, in a few queries."""
    asked = (
        select(SubmittedAssignment.student_id, SubmittedNotebook)
        .join(SubmittedAssignment, SubmittedNotebook.assignment_id == SubmittedAssignment.id)
        .join(Notebook, SubmittedNotebook.notebook_id == Notebook.id)
        .join(Assignment, SubmittedAssignment.assignment_id == Assignment.id)
        .where(Assignment.name == assignment, Notebook.name == assignment)
        .options(
            selectinload(SubmittedNotebook.grades).selectinload(Grade.cell),
            selectinload(SubmittedNotebook.comments).selectinload(Comment.cell),
        )
    )
    found: dict[str, SubmittedNotebook] = {}
    for first in range(0, len(students), MOST_ASKED):
        some = SubmittedAssignment.student_id.in_(students[first : first + MOST_ASKED])
        for student, notebook in book.db.execute(asked.where(some)):
            found[student] = notebook
    return found


def _scores(
    student: str,
    assignment: str,
    cells: Sequence[GradeCell],
    found: SubmittedNotebook | None,
) -> Iterator[CellScore]:
    grades = {grade.name: grade for grade in found.grades} if found else {}
    comments = (
        {comment.name: comment.manual_comment for comment in found.comments} if found else {}
    )
    for cell in cells:
        grade = grades.get(cell.name)
        yield CellScore(
            student_id=student,
            assignment=assignment,
            grade_id=cell.name,
            score=grade.score if grade and not needs_manual_grade(grade) else None,
            max_score=cell.max_score,
            submitted=found is not None,
            by_hand=bool(grade and grade.manual_score is not None),
            comment=comments.get(cell.name) or '',
        )
    if found and found.late_submission_penalty:
        yield CellScore(student, assignment, 'late_penalty', -found.late_submission_penalty, 0.0)


def _place_in(course: Course, assignment: str) -> Callable[[GradeCell], tuple[int, str]]:
    """Return a sort key for the lesson's order; cells that the lesson lacks come last."""
    order: list[str] = []
    if course.source_path(assignment).exists():
        order = list(checksums(course, assignment))
    return lambda cell: (order.index(cell.name) if cell.name in order else len(order), cell.name)
