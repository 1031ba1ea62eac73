"""What the gradebook and the executed notebooks say, cell by cell."""

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
from grader.notebook.own_files import parsed
from grader.notebook.restore import KEY, grade_id
from grader.storage.database import connected
from grader.storage.gradebook import opened, waits_for_a_person
from grader.storage.lesson_checksums import checksums
from grader.storage.registering import withdrawn

MOST_ASKED = 500
"""Of so many students a database is asked at once; all of them have a limit."""


@dataclass(frozen=True)
class CellScore:
    """One graded cell of one student."""

    student_id: str
    assignment: str
    grade_id: str
    score: float | None
    """None where nothing was handed in, or where a person has to decide."""
    max_score: float
    submitted: bool = True
    by_hand: bool = False
    """Whether a person gave the score."""
    comment: str = ''
    """What a person wrote."""


def records(course: Course, *, only: Collection[tuple[str, str]] | None = None) -> list[CellScore]:
    """Return all graded cells of all students, in a stable order; registers what is new.

    A lesson that solutions/ has no longer is left out, unless somebody has a score for it. `only`
    asks for some submissions that were graded, as pairs of student and assignment.
    """
    with opened(course) if only is None else connected(course.db_url) as book:
        cells_of = _cells_of(course, book, only)
        students = sorted(book.db.scalars(select(Student.id)))
        asked = {*only} if only is not None else {*product(students, cells_of)}
        found: dict[tuple[str, str], list[CellScore]] = {}
        for assignment, cells in cells_of.items():
            whose = [student for student in students if (student, assignment) in asked]
            graded = _graded(book, assignment, whose)
            for student in whose:
                scores = _scores(student, assignment, cells, graded.get(student))
                found[student, assignment] = [*scores]
            book.db.expunge_all()  # no lesson of a large class is needed beside another
        return [record for whose in sorted(found) for record in found[whose]]


def _cells_of(
    course: Course, book: Gradebook, only: Collection[tuple[str, str]] | None
) -> dict[str, list[GradeCell]]:
    """Return the graded cells of each assignment that is asked for, in the lesson's order."""
    names = {name for [name] in book.db.execute(select(Assignment.name))}
    if only is None:
        names -= {name for name, number in withdrawn(course, book).items() if not number}
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
    """Return what the executed notebook says of each graded cell, by grade id."""
    return verdicts_in(graded_notebook(course, student_id, assignment))


def verdicts_in(graded: NotebookNode) -> dict[str, dict]:
    """Return what an executed notebook says of each graded cell, by grade id."""
    return {name: cell.metadata.get(KEY, {}) for cell in graded.cells if (name := grade_id(cell))}


def graded_notebook(course: Course, student_id: str, assignment: str) -> NotebookNode:
    """Return the executed notebook of a submission; one without cells where there is none.

    Raises DamagedResult where the file is no notebook any more.
    """
    path = course.folder('autograded', student_id, assignment) / f'{assignment}.ipynb'
    if not path.exists():
        return nbformat.v4.new_notebook()
    try:
        return parsed(path.read_text('utf-8'))
    except ValueError:
        again = f'run ./course grade --student {student_id}, which grades it again'
        raise DamagedResult(f'the graded notebook {path} is damaged: {again}') from None


def _graded(
    book: Gradebook, assignment: str, students: Sequence[str]
) -> dict[str, SubmittedNotebook]:
    """Return what the database holds of an assignment, by student: all in a few questions."""
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
            score=grade.score if grade and not waits_for_a_person(grade) else None,
            max_score=cell.max_score,
            submitted=found is not None,
            by_hand=bool(grade and grade.manual_score is not None),
            comment=comments.get(cell.name) or '',
        )
    if found and found.late_submission_penalty:
        yield CellScore(student, assignment, 'late_penalty', -found.late_submission_penalty, 0.0)


def _place_in(course: Course, assignment: str) -> Callable[[GradeCell], tuple[int, str]]:
    """Return a sort key that puts graded cells in the lesson's order; strangers come last."""
    order: list[str] = []
    if course.source_path(assignment).exists():
        order = list(checksums(course, assignment))
    return lambda cell: (order.index(cell.name) if cell.name in order else len(order), cell.name)
