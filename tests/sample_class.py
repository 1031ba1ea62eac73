"""The sample class for test modules: what each sample is expected to earn; hand in and grade."""

import json
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path

from changed_packages import ALL
from package_changes import LESSON, Files, write

from grader.course import Course
from grader.grade import grade_all
from grader.grading import SubmissionOutcome
from grader.storage.submitted import find_submissions
from grader.workers.backend import Backend

FOLDER = Path(__file__).parent / 'submissions'
sys.path.insert(0, str(FOLDER))

from rebase import assignment_of, rebased, samples  # noqa: E402 - found only now

__all__ = ['EXPECTED', 'FOLDER', 'PATHS', 'assignment_of', 'grade', 'hand_in', 'rebased']

_CHANGES = {change.name: change for change in ALL}

PATHS = {path.stem: path for path in samples()}
"""Every sample, by name."""
EXPECTED = {
    sample: cells
    for path in sorted(FOLDER.glob('expected/*.json'))
    for sample, cells in json.loads(path.read_text(encoding='utf-8')).items()
}
"""By sample and grade cell: its score, and what its reason must contain."""


def package_of(name: str) -> Files:
    """Return the files of the package that a sample hands in, by path; none if it has no package.

    It is our package with the change of tests/changed_packages.py that has the sample's name.
    """
    assignment, _, why = name.split('-', 2)
    return _CHANGES[why].files() if assignment == LESSON and why != 'untouched' else {}


def hand_in(course: Course, names: Iterable[str]) -> None:
    """Put samples into a course's submitted/; each is a student of its own."""
    for name in names:
        assignment = assignment_of(PATHS[name])
        folder = course.folder('submitted', name, assignment)
        folder.mkdir(parents=True)
        shutil.copyfile(PATHS[name], folder / f'{assignment}.ipynb')
        write(package_of(name), folder)


def grade(
    course: Course, names: Iterable[str], *, backend: Backend | None = None
) -> dict[str, SubmissionOutcome]:
    """Grade samples as `./course grade` does; return the outcomes by sample."""
    hand_in(course, names)
    return {
        row.student_id: row for row in grade_all(course, find_submissions(course), backend=backend)
    }
