"""Every way of grading gives the sample class the scores that `./course grade` gives it."""

import os
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import pytest
from sample_class import EXPECTED, PATHS, assignment_of, hand_in

from grader.course import ROOT, Course
from grader.storage.records import records, verdicts

BY_COMMAND = (
    '03_publisher-fail-os_exit',
    '03_publisher-pass-deleted_grade_cells',
    '03_publisher-zero-another_assignment',
    '03_publisher-zero-not_json',
    '12_package-fail-no_setup_py',
)
"""One of each outcome, and a package; `./course test --slow` takes all of them."""
FORMGRADER = """
import asyncio, sys
from nbgrader.apps import NbGrader
from nbgrader.apps.api import NbGraderAPI

async def grade(assignment, *students):
    app = NbGrader()
    app.initialize([])
    api = NbGraderAPI(app.coursedir, parent=app)
    for student in students:
        result = api.autograde(assignment, student)
        assert result['success'], result

asyncio.run(grade(*sys.argv[1:]))
"""
"""What the formgrader does at a click, inside its event loop."""


@pytest.fixture
def course(tmp_path):
    """The real lessons, in a folder where nothing was graded yet."""
    for part in ('solutions', 'notebooks'):
        shutil.copytree(ROOT / part, tmp_path / part)
    shutil.copy(ROOT / 'nbgrader_config.py', tmp_path)
    return Course.at(tmp_path)


@pytest.mark.slow  # test_nbgrader_commands.py does so with a small lesson
@pytest.mark.timeout(3600)  # one answer after the other
@pytest.mark.parametrize('names', [BY_COMMAND, tuple(PATHS)], ids=['some', 'all'])
def test_nbgrader_autograde_gives_the_sample_class_its_expected_scores(course, names):
    hand_in(course, names)
    for assignment in by_assignment(names):
        run = python(course, '-m', 'nbgrader', 'autograde', assignment)
        assert run.returncode == 0, run.stderr
    assert wrong(course, names) == []


@pytest.mark.slow
@pytest.mark.timeout(3600)  # one answer after the other
def test_the_formgrader_gives_the_sample_class_its_expected_scores(course):
    hand_in(course, PATHS)
    for assignment, students in by_assignment(PATHS).items():
        run = python(course, '-c', FORMGRADER, assignment, *students)
        assert run.returncode == 0, run.stderr
    assert wrong(course, PATHS) == []


def by_assignment(names):
    students = defaultdict(list)
    for name in names:
        students[assignment_of(PATHS[name])].append(name)
    return students


def python(course, *arguments):
    """Run a command in the course's folder, as from its environment's command line."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=course.root,
        env=os.environ | {'PATH': path},
        capture_output=True,
        text=True,
        check=False,
    )


def wrong(course, names):
    """Return scores that are not as expected, with reasons: the course is deleted afterwards."""
    found = {(r.student_id, r.assignment, r.grade_id): r.score for r in records(course)}
    differ = []
    for name in names:
        assignment = assignment_of(PATHS[name])
        for grade_id, (points, *_) in EXPECTED[name].items():
            score = found.get((name, assignment, grade_id))
            if score != points:
                why = verdicts(course, name, assignment).get(grade_id)
                differ.append((name, grade_id, score, points, why))
    return differ
