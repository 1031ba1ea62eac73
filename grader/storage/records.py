"""What the gradebook and the executed notebooks say, cell by cell."""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

import nbformat
from nbformat import NotebookNode
from nbgrader.api import Assignment, Gradebook, GradeCell, Notebook
from sqlalchemy import select

from grader.course import Course
from grader.notebook.restore import KEY, grade_id
from grader.storage.database import connected
from grader.storage.gradebook import opened, submitted_notebook, waits_for_a_person
from grader.storage.lesson_checksums import checksums


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

    `only` asks for some submissions that were graded, as pairs of student and assignment.
    """
    with opened(course) if only is None else connected(course.db_url) as book:
        cells_of = _cells_of(course, book, only)
        return [
            record
            for student in sorted(student.id for student in book.students)
            for assignment, cells in cells_of.items()
            if only is None or (student, assignment) in only
            for record in _records(book, student, assignment, cells)
        ]


def _cells_of(
    course: Course, book: Gradebook, only: Collection[tuple[str, str]] | None
) -> dict[str, list[GradeCell]]:
    """Return the graded cells of each assignment that is asked for, in the lesson's order."""
    names = sorted(name for [name] in book.db.execute(select(Assignment.name)))
    if only is not None:
        names = sorted({assignment for _, assignment in only}.intersection(names))
    asked = (
        select(Assignment.name, GradeCell)
        .join(Notebook, GradeCell.notebook_id == Notebook.id)
        .join(Assignment, Notebook.assignment_id == Assignment.id)
        .where(Assignment.name.in_(names))
    )
    found: dict[str, list[GradeCell]] = {name: [] for name in names}
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
    """Return the executed notebook of a submission; one without cells where there is none."""
    path = course.folder('autograded', student_id, assignment) / f'{assignment}.ipynb'
    return nbformat.read(path, as_version=4) if path.exists() else nbformat.v4.new_notebook()


def _records(
    book: Gradebook, student: str, assignment: str, cells: Sequence[GradeCell]
) -> Iterator[CellScore]:
    found = submitted_notebook(book, student, assignment)
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
