"""Why a lesson in solutions/ can't be released or graded, in terms that its author knows."""

from collections.abc import Iterable, Iterator

from grader.authoring.exercise_cells import outside_of_exercises
from grader.authoring.markers import marker_faults
from grader.authoring.metadata_faults import metadata_faults
from grader.common.errors import CourseError
from grader.course import Course


def refuse_faulty(course: Course, assignments: Iterable[str]) -> None:
    """Raise CourseError with each lesson and cell that has a fault, and what to do about it.

    nbgrader's own messages name neither the lesson nor the cell.
    """
    if faults := [fault for name in assignments for fault in _faults(course, name)]:
        raise CourseError('; '.join(faults))


def refuse_misnamed(course: Course) -> None:
    """Raise CourseError if a folder has only a notebook of another name.

    nbgrader would release that, and none of our checks would look at it.
    """
    names = course.assignments()
    found = sorted((course.root / 'solutions').glob('[!.]*/[!.]*.ipynb'))
    if faults := [
        f'{path.relative_to(course.root)} cannot be released: give the notebook the name of its'
        f' folder, {path.parent.name}.ipynb'
        for path in found
        if path.parent.name not in names
    ]:
        raise CourseError('; '.join(faults))


def _faults(course: Course, name: str) -> Iterator[str]:
    source = course.source(name)
    where = f'solutions/{name}/{name}.ipynb'
    faults = [*metadata_faults(source), *marker_faults(source)]
    # an answer without its type would also leave its checks without an exercise
    for fault in faults or outside_of_exercises(source):
        yield f'{where} cannot be released: {fault}'
