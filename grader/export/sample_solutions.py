"""Make the notebooks for after the deadline: with answers, without hidden tests."""

import re
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

import nbformat
from my_robot_basics.session import package_files
from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode

from grader.authoring.demo_outputs import keep_outputs
from grader.authoring.leaks import BROKEN
from grader.authoring.release import last_release, sanitizer_of
from grader.common.errors import CourseError
from grader.common.files import write_whole
from grader.course import Course
from grader.storage.deadlines import Deadlines, deadlines
from grader.storage.pipeline import apply_preprocessors, resources_of

PASSES = (
    'grader.authoring.release_passes.TidyMetadata',
    'nbgrader.preprocessors.LockCells',
    'grader.export.sample_solutions.ShowSolutions',
    'grader.authoring.release_passes.KeepDemoOutputs',
    'nbgrader.preprocessors.ClearHiddenTests',
    'nbgrader.preprocessors.ClearMarkScheme',
    'nbgrader.preprocessors.ComputeChecksums',
)
_MARKS = re.compile(rf'^ *### (BEGIN|END) SOLUTION *\n?|^ *{BROKEN}.*\n?', re.MULTILINE)


class ShowSolutions(Preprocessor):
    """Show answers as a student would write them: without BEGIN and END lines and broken lines."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Clean one cell."""
        cell.source = _MARKS.sub('', cell.source).rstrip('\n')
        return cell, resources


def write_solutions(
    course: Course, assignments: Sequence[str] = (), *, early: bool = False
) -> list[Path]:
    """Write gradebook/solutions/<assignment>.ipynb, by default for all; return the paths.

    A ROS package that is an answer is put beside its notebook. Raises CourseError, and writes
    nothing, if a student may still hand in, unless `early`.
    """
    wanted = assignments or course.assignments()
    sources = {assignment: course.source(assignment) for assignment in wanted}
    if not early:
        _refuse_before_the_deadline(course, wanted)
    folder = course.gradebook / 'solutions'
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for assignment, source in sources.items():
        solved = apply_preprocessors(PASSES, source, resources_of(course, assignment))
        keep_outputs(solved, last_release(course, assignment), sanitizer_of(course))
        paths.append(folder / f'{assignment}.ipynb')
        write_whole(paths[-1], nbformat.writes(solved) + '\n')
        for package in course.packages(assignment):  # the notebook looks for it beside itself
            place = course.source_path(assignment).parent / package
            package_files.write(package_files.read(place).taken, folder / package)
    return paths


def _refuse_before_the_deadline(course: Course, assignments: Sequence[str]) -> None:
    found = deadlines(course.gradebook, course.assignments()) or Deadlines()
    now = datetime.now(UTC).replace(tzinfo=None)
    for assignment in assignments:
        extended = [until for (name, _), until in found.extended.items() if name == assignment]
        last = max([*extended, found.due.get(assignment, now)])
        if last > now:
            until = last.replace(tzinfo=UTC).astimezone()
            raise CourseError(
                f'no solution was written: {assignment} can be handed in until '
                f'{until:%Y-%m-%d %H:%M %Z}. --early writes it anyway'
            )
