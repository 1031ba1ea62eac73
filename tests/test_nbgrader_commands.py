"""nbgrader's own commands, in real rooms, give the same scores and pages as ours."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, make_course, submit
from hostile_papers import STOPS_DATEUTIL
from nbformat import NotebookNode

from grader.__main__ import main
from grader.authoring.release import release
from grader.course import Course
from grader.storage.records import records
from grader.storage.registering import register

ANSWERS = {
    'right': 'def double(x):\n    return 2 * x',
    'small': 'def double(x):\n    return 2 * x if x < 10 else 0',
    'silent': '# nothing',
}


@pytest.fixture(scope='module')
def courses(tmp_path_factory):
    """The same class graded twice: by `./course grade`, and by `nbgrader autograde`."""
    theirs = make_course(tmp_path_factory.mktemp('course'))
    ours = Course(root=theirs.root, gradebook=tmp_path_factory.mktemp('ours'))
    nbgrader(theirs, 'generate_assignment', TOY)
    # nbgrader has released and registered just what we would
    released = theirs.release_path(TOY).read_bytes()
    release(theirs, TOY)
    assert theirs.release_path(TOY).read_bytes() == released
    assert not register(theirs, TOY)
    for course in (ours, theirs):
        for student, answer in ANSWERS.items():
            submit(course, student, answered(course, answer, explained='so'))
        submit(course, 'right', mangled(answered(course, ANSWERS['right'])))
        path = submit(course, 'hostile', hostile(answered(course, ANSWERS['right'])))
        path.with_name('timestamp.txt').write_text(STOPS_DATEUTIL)
    assert main(['grade'], course=ours) == 0
    said = nbgrader(theirs, 'autograde', TOY)
    assert 'Traceback' not in said
    return ours, theirs


def mangled(notebook: NotebookNode) -> NotebookNode:
    """Return a notebook without its first check and its manual answer, and with 50 points."""
    notebook.cells = [c for c in notebook.cells if c.id not in ('double-check', 'explain')]
    notebook.cells[-1].metadata['nbgrader']['points'] = 50
    return notebook


def hostile(notebook: NotebookNode) -> str:
    """Return a notebook that is right, and that nbformat's checks take 40 s and 1.4 GB for."""
    raw = json.loads(nbformat.writes(notebook))
    raw['cells'].append(raw['cells'][0] | {'outputs': [{'output_type': 'x'}] * 30_000})
    return json.dumps(raw)


def nbgrader(course: Course, *arguments: str) -> str:
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
    run = subprocess.run(
        [sys.executable, '-m', 'nbgrader', *arguments],
        cwd=course.root,
        capture_output=True,
        text=True,
        env={k: v for k, v in os.environ.items() if k != 'PYTEST_CURRENT_TEST'} | {'PATH': path},
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return run.stderr


@pytest.mark.slow
def test_course_grade_and_nbgrader_autograde_give_the_same_scores(courses):
    ours, theirs = (
        {(r.student_id, r.grade_id): r.score for r in records(course)} for course in courses
    )
    assert ours == theirs
    assert ours == {
        ('hostile', 'double-check'): 1.0,
        ('hostile', 'double-hidden'): 2.0,
        ('hostile', 'explain'): 0.0,
        ('right', 'double-check'): 1.0,
        ('right', 'double-hidden'): 2.0,
        ('right', 'explain'): 0.0,
        ('silent', 'double-check'): 0.0,
        ('silent', 'double-hidden'): 0.0,
        ('silent', 'explain'): None,
        ('small', 'double-check'): 1.0,
        ('small', 'double-hidden'): 0.0,
        ('small', 'explain'): None,
    }


@pytest.mark.slow
def test_course_feedback_and_nbgrader_write_the_same_pages(courses):
    ours, theirs = courses
    assert main(['feedback'], course=ours) == 0
    nbgrader(theirs, 'generate_feedback', TOY)
    for student in ANSWERS:
        a, b = (c.folder('feedback', student, TOY) / f'{TOY}.html' for c in courses)
        assert a.read_text() == b.read_text()
        assert 'canary' not in a.read_text()


@pytest.mark.slow  # a test above reads the same scores from the same database
def test_nbgrader_exports_the_scores_of_course_grade(courses):
    ours, _ = courses
    nbgrader(ours, 'export', f'--CourseDirectory.db_url={ours.db_url}', '--to', 'ours.csv')
    with (ours.root / 'ours.csv').open() as file:
        total = {row['student_id']: float(row['score']) for row in csv.DictReader(file)}
    assert total == {'hostile': 3.0, 'right': 3.0, 'small': 1.0, 'silent': 0.0}


@pytest.mark.slow
def test_the_formgrader_gives_the_same_scores_in_its_event_loop(courses):
    _, theirs = courses
    before = [r for r in records(theirs) if r.student_id == 'small']
    code = (
        'import asyncio, sys\n'
        'from nbgrader.apps import NbGrader\n'
        'from nbgrader.apps.api import NbGraderAPI\n'
        'async def grade():\n'
        '    app = NbGrader()\n'
        '    app.initialize([])\n'
        '    api = NbGraderAPI(app.coursedir, parent=app)\n'
        f'    result = api.autograde({TOY!r}, "small", force=True)\n'
        '    assert result["success"], result\n'
        '    from pathlib import Path\n'
        '    import subprocess\n'
        '    free = ["flock", "--nonblock", "gradebook/.lock", "true"]\n'
        '    assert subprocess.run(free).returncode == 0, "the lock is still held"\n'
        'asyncio.run(grade())\n'
    )
    run = subprocess.run(
        [sys.executable, '-c', code], cwd=theirs.root, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    assert [r for r in records(theirs) if r.student_id == 'small'] == before


@pytest.mark.slow
def test_nbgrader_stops_with_advice_if_the_grader_package_is_missing(courses):
    ours, _ = courses
    code = (
        'import sys\n'
        'sys.modules["grader"] = None\n'
        'sys.argv = ["nbgrader", "autograde", "x"]\n'
        'from nbgrader.apps.nbgraderapp import main\n'
        'main()\n'
    )
    run = subprocess.run(
        [sys.executable, '-c', code], cwd=ours.root, capture_output=True, text=True, check=False
    )
    assert run.returncode == 1
    assert run.stderr.strip().endswith('and use .venv/bin/nbgrader.')
    assert 'Traceback' not in run.stderr
