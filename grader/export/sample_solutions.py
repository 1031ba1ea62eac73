"""Make the notebooks for after the deadline: with answers, without hidden tests."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
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
from grader.storage.due_dates import in_local_time, open_until
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


@dataclass(frozen=True)
class SampleSolutions:
    """What was written, and what was not."""

    paths: tuple[Path, ...]
    """The notebooks that were written."""
    left_out: tuple[str, ...]
    """For each lesson without a solution, its name and the reason."""
    early: str = ''
    """A sentence on solutions of such lessons that were written before, or ''."""


def write_solutions(
    course: Course, assignments: Sequence[str] = (), *, early: bool = False
) -> SampleSolutions:
    """Write gradebook/solutions/<assignment>.ipynb, by default for each closed lesson.

    A ROS package that is an answer is put beside its notebook. With `early`, due dates do not
    matter. Raises CourseError, and writes nothing, if one of `assignments` is open, or if all
    lessons are.
    """
    wanted = assignments or course.assignments()
    sources = {assignment: course.source(assignment) for assignment in wanted}
    open_ones = {} if early else _find_open(course, wanted, are_named=bool(assignments))
    early_ones = _describe_early(course, open_ones)
    if open_ones and (assignments or len(open_ones) == len(sources)):
        reasons = '; '.join(open_ones.values())
        raise CourseError(
            f'no solution was written: {reasons}. --early writes it anyway. {early_ones}'.rstrip()
        )
    paths = []
    for assignment, source in sources.items():
        if assignment in open_ones:
            continue
        solved = apply_preprocessors(PASSES, source, resources_of(course, assignment))
        keep_outputs(solved, last_release(course, assignment), sanitizer_of(course))
        paths.append(course.solution_path(assignment))
        paths[-1].parent.mkdir(parents=True, exist_ok=True)
        write_whole(paths[-1], nbformat.writes(solved) + '\n')
        for package in course.packages(assignment):  # the notebook looks for it beside itself
            place = course.source_path(assignment).parent / package
            package_files.write(package_files.read(place).taken, paths[-1].parent / package)
    return SampleSolutions(tuple(paths), tuple(open_ones.values()), early_ones)


def _find_open(course: Course, assignments: Sequence[str], *, are_named: bool) -> dict[str, str]:
    """Return the lessons that can still be handed in, each with a text that says until when.

    In a course with due dates, a lesson without one has not got it yet: it is open, too, unless
    it `are_named`.
    """
    found = deadlines(course.gradebook, course.assignments()) or Deadlines()
    open_ones = {}
    for assignment in assignments:
        if until := open_until(found, assignment):
            open_ones[assignment] = f'{assignment} can be handed in until {in_local_time(until)}'
        elif assignment not in found.due and found.due and not are_named:
            open_ones[assignment] = f'{assignment} has no due date (./course due)'
    return open_ones


def _describe_early(course: Course, open_ones: Iterable[str]) -> str:
    """Return a sentence on answers of open lessons that were written before, or ''."""
    names = [name for name in open_ones if course.solution_path(name).exists()]
    if not names:
        return ''
    return (
        f'gradebook/solutions/ has answers from before, for {", ".join(names)}: unless students '
        'have them already, remove them.'
    )
