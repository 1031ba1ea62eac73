"""Tell nbgrader's database what an assignment consists of."""

from nbgrader.api import Gradebook, MissingEntry

from grader.authoring.release_passes import PASSES
from grader.common.errors import CourseError
from grader.course import Course
from grader.notebook.restore import grade_id
from grader.storage.database import connected, make_database
from grader.storage.pipeline import apply, resources_of

SAVE_CELLS = 'nbgrader.preprocessors.SaveCells'


def register(course: Course, assignment: str) -> bool:
    """Tell the database what an assignment consists of; return whether that was news to it.

    Raises CourseError when cells came or went although submissions are graded already.
    """
    resources = resources_of(course, assignment)
    tidied = apply(PASSES[: PASSES.index(SAVE_CELLS)], course.source(assignment), resources)
    make_database(course)
    with connected(course.db_url) as book:
        known = _checksums_in(book, assignment)
        wanted = {
            grade_id(cell) or '': cell.metadata['nbgrader']['checksum']
            for cell in tidied.cells
            if 'checksum' in cell.metadata.get('nbgrader', {})
        }
        if known == wanted:
            return False
        came, went = (
            sorted(wanted.keys() - (known or wanted)),
            sorted((known or {}).keys() - wanted),
        )
        if (came or went) and book.assignment_submissions(assignment):
            raise CourseError(
                f"{assignment} can't be changed like this after submissions were graded "
                f'(new cells: {", ".join(came) or "none"}; gone: {", ".join(went) or "none"}): '
                'give the cells their former grade ids, or keep this gradebook/ elsewhere and '
                'begin a new one.'
            )
        book.update_or_create_assignment(assignment)
    apply((SAVE_CELLS,), tidied, resources)
    return True


def _checksums_in(book: Gradebook, assignment: str) -> dict[str, str] | None:
    try:
        cells = book.find_notebook(assignment, assignment).source_cells
    except MissingEntry:
        return None
    return {cell.name: cell.checksum for cell in cells}
