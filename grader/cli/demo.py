"""Grade a sample class, in which file names say the expected outcomes."""

import shutil
import tempfile
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

from grader.common.errors import CourseError
from grader.course import ROOT, Course
from grader.grade import grade_all
from grader.grading import SubmissionOutcome
from grader.kernels.isolation import NO_SANDBOX, require_isolation
from grader.report.feedback import write_feedback
from grader.report.progress_table import print_rows
from grader.report.report import Run, write_report
from grader.storage.records import verdicts
from grader.storage.submitted import find_submissions

SAMPLES = ROOT / 'tests' / 'submissions'

OUTCOMES: dict[str, Callable[[list[str]], bool]] = {
    'pass': lambda outcomes: set(outcomes) == {'passed'},
    'fail': lambda outcomes: (
        bool({'partial', 'failed'} & {*outcomes}) and 'ungraded' not in outcomes
    ),
    'mixed': lambda outcomes: set(outcomes) == {'passed', 'failed'},
    'zero': lambda outcomes: set(outcomes) == {'failed'},
}
"""Conditions for the outcomes of a sample's checks, by the second part of its name."""


def demo(samples: Path = SAMPLES, *, root: Path = ROOT) -> bool:
    """Grade `<assignment>-<outcome>-<why>.ipynb`, print the table; return whether all are right.

    The gradebook is a temporary folder, which is kept for inspection.
    """
    course = Course(root=root, gradebook=Path(tempfile.mkdtemp(prefix='my_robot_basics-demo-')))
    expected = {}
    for sample in sorted(samples.glob('*.ipynb')):
        assignment, outcome, _ = _parts(sample, course)
        expected[sample.stem] = outcome
        hand_in(course, sample, assignment)
    submissions = find_submissions(course)
    if not require_isolation(trust_students=True):
        print(f'The samples are {NO_SANDBOX}. They are part of the course, and do no harm.')
    graded = grade_all(course, submissions, trust_students=True)
    run = Run(datetime.now().astimezone())
    rows = list(print_rows(graded, submissions, expected=expected))
    surprises = [row for row in rows if not _is_as_expected(course, row, expected[row.student_id])]
    pages = write_feedback(course)
    for row in surprises:
        print(f'NOT AS NAMED: {row.student_id}: {row.reason or "no points are missing"}')
    print(f'{len(submissions) - len(surprises)} of {len(submissions)} came out as named.')
    if pages:
        print(f'A page of feedback: {_most_telling(pages, expected)}')
    print(f'A report of the run: {write_report(course, run, rows)}')
    return not surprises


def hand_in(course: Course, sample: Path, assignment: str) -> None:
    """Put a sample into submitted/.

    A package that its lesson needs is copied from the solution; files in a folder with the
    sample's name replace those.
    """
    folder = course.folder('submitted', sample.stem, assignment)
    folder.mkdir(parents=True)
    shutil.copyfile(sample, folder / f'{assignment}.ipynb')
    for package in course.packages(assignment):
        ours = course.source_path(assignment).with_name(package)
        if ours.is_dir():
            shutil.copytree(ours, folder / package)
    if sample.with_suffix('').is_dir():
        shutil.copytree(sample.with_suffix(''), folder, dirs_exist_ok=True)


def _parts(sample: Path, course: Course) -> tuple[str, str, str]:
    parts = sample.stem.split('-', 2)
    if len(parts) == 3 and parts[0] in course.assignments() and parts[1] in OUTCOMES:
        return parts[0], parts[1], parts[2]
    raise CourseError(
        f'{sample.name} is not named <assignment>-<{"|".join(OUTCOMES)}>-<why>.ipynb after one of '
        f'{", ".join(course.assignments())}'
    )


def _is_as_expected(course: Course, row: SubmissionOutcome, outcome: str) -> bool:
    said = verdicts(course, row.student_id, row.assignment).values()
    outcomes = [verdict['outcome'] for verdict in said if 'outcome' in verdict]
    return row.stored is not None and OUTCOMES[outcome](outcomes)


def _most_telling(pages: list[Path], expected: dict[str, str]) -> Path:
    """Return the page of a student who has something to fix."""
    return next((p for p in pages if expected[p.parts[-3]] != 'pass'), pages[0])
