"""Register assignments in nbgrader's database: which cells they have."""

from nbgrader.api import (
    Assignment,
    Gradebook,
    MissingEntry,
    Notebook,
    SourceCell,
    SubmittedAssignment,
)
from sqlalchemy import func, select

from grader.common.errors import CourseError
from grader.course import Course
from grader.storage.database import make_database, open_database
from grader.storage.lesson_checksums import SAVE_CELLS, checksums, lesson_to_register
from grader.storage.pipeline import apply_preprocessors, resources_of


def register(course: Course, assignment: str) -> bool:
    """Write into the database which cells an assignment has; return whether anything was new.

    Raises CourseError if cells were added or removed after submissions were graded.
    """
    wanted = checksums(course, assignment)
    make_database(course)
    with open_database(course.db_url) as book:
        known = _checksums_in(book, assignment)
        if known == wanted:
            return False
        came, went = (
            sorted(wanted.keys() - (known or wanted)),
            sorted((known or {}).keys() - wanted),
        )
        if (came or went) and book.assignment_submissions(assignment):
            way_out = (
                'give the cells their former grade ids'
                if went
                else 'take the new cells out, or put them into a lesson of their own'
            )
            raise CourseError(
                f"{assignment} can't be changed like this after submissions were graded "
                f'(new cells: {", ".join(came) or "none"}; gone: {", ".join(went) or "none"}): '
                f'{way_out}, or keep this gradebook/ elsewhere and begin a new one.'
            )
        book.update_or_create_assignment(assignment)
    apply_preprocessors(
        (SAVE_CELLS,), lesson_to_register(course, assignment), resources_of(course, assignment)
    )
    return True


def register_all(course: Course) -> None:
    """Register every assignment that is new, or differs from what the database has.

    Raises CourseError as `register` does.
    """
    wanted = {name: checksums(course, name) for name in course.assignments()}
    make_database(course)
    asked = (
        select(Assignment.name, SourceCell.name, SourceCell.checksum)
        .join(Notebook, SourceCell.notebook_id == Notebook.id)
        .join(Assignment, Notebook.assignment_id == Assignment.id)
        .where(Notebook.name == Assignment.name)
    )
    known: dict[str, dict[str, str]] = {}
    with open_database(course.db_url) as book:
        for assignment, name, checksum in book.db.execute(asked):
            known.setdefault(assignment, {})[name] = checksum
    for assignment, cells in wanted.items():
        if known.get(assignment) != cells:
            register(course, assignment)


def withdrawn(course: Course, book: Gradebook) -> dict[str, int]:
    """Return the assignments that the database has and solutions/ no longer has.

    With the number of graded submissions of each.
    """
    asked = (
        select(Assignment.name, func.count(SubmittedAssignment.id))
        .outerjoin(SubmittedAssignment, SubmittedAssignment.assignment_id == Assignment.id)
        .group_by(Assignment.name)
    )
    known = course.assignments()
    return {name: number for name, number in book.db.execute(asked) if name not in known}


def withdrawn_unseen(course: Course, book: Gradebook) -> set[str]:
    """Return those of `withdrawn` that nobody has handed in: no table lists them."""
    return {name for name, number in withdrawn(course, book).items() if not number}


def _checksums_in(book: Gradebook, assignment: str) -> dict[str, str] | None:
    try:
        cells = book.find_notebook(assignment, assignment).source_cells
    except MissingEntry:
        return None
    return {cell.name: cell.checksum for cell in cells}
