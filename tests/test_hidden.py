"""Hidden tests stay hidden: nothing that a class leaves behind holds any of their text."""

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, make_course, submit, toy_lesson, write_source

from grader.__main__ import main

pytestmark = pytest.mark.isolation

CANARIES = ('hidden canary', 'canary_of_a_name', 'canary of a broken test')
ANSWERS = {
    'wrong': 'def double(x):\n    return 0 if x else 0.0',
    'raises': 'def double(x):\n    return {}[x]',
    'exits': 'import os\ndef double(x):\n    os._exit(0)',
    'tells': 'import sys\ndef double(x):\n    print(x, file=sys.stderr)\n    return "x" * x * 99',
    'interrupts': 'def double(x):\n    raise KeyboardInterrupt(x)',
}


@pytest.fixture(scope='module')
def left(tmp_path_factory):
    """A course that was graded, reported and exported; what was printed and logged meanwhile."""
    course = make_course(tmp_path_factory.mktemp('hidden'))
    lesson = toy_lesson()
    cells = {cell.id: cell for cell in lesson.cells}
    cells['double-hidden'].source = cells['double-hidden'].source.replace(
        'assert', 'canary_of_a_name = student.call("double", 7)\nassert'
    )
    # the instructor's own mistake, which ends every check in an error that names a line of it
    cells[
        'double-check'
    ].source += '\n### BEGIN HIDDEN TESTS\n{}["canary of a broken test"]\n### END HIDDEN TESTS'
    write_source(course, lesson)
    assert main(['release'], course=course) == 0
    for student, answer in ANSWERS.items():
        submit(course, student, answered(course, answer))
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
    run = subprocess.run(
        [sys.executable, '-P', '-c', RUN],
        cwd=course.root,
        env=os.environ | {'PATH': path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return course, run.stdout + run.stderr


RUN = (
    'from pathlib import Path\n'
    'from grader.__main__ import main\n'
    'from grader.course import Course\n'
    'from nbgrader.apps import ExportApp\n'
    'for verb in ("grade", "feedback", "scores"):\n'
    '    assert main([verb], course=Course.at(Path.cwd())) == 0\n'
    'ExportApp.launch_instance(["--to", "export.csv"])\n'
)


def found_in(text):
    return [canary for canary in CANARIES if canary in text]


@pytest.mark.slow
def test_logs_and_terminal_output_hold_no_hidden_test(left):
    _, said = left
    assert 'wrong' in said
    assert 'interrupts' in said
    assert found_in(said) == []


@pytest.mark.slow
def test_exports_feedback_and_reports_hold_no_hidden_test(left):
    course, _ = left
    seeds = [course.seed(TOY, student) for student in ANSWERS]
    told = [course.root / 'export.csv', course.gradebook / 'scores.csv']
    told += course.folder('feedback', '', '').rglob('*.html')
    assert len(told) == 2 + len(ANSWERS)
    for path in told:
        text = path.read_text(encoding='utf-8')
        assert text
        assert (found_in(text), [s for s in seeds if s in text]) == ([], []), path
    reports = [*(course.gradebook / 'runs').rglob('report.*')]
    assert reports
    for path in reports:
        assert found_in(path.read_text(encoding='utf-8')) == [], path


@pytest.mark.slow
def test_released_files_hold_no_hidden_test(left):
    course, _ = left
    given = [path for path in (course.root / 'notebooks').rglob('*') if path.is_file()]
    assert course.release_path(TOY) in given
    for path in given:
        assert found_in(path.read_text(encoding='utf-8')) == [], path


@pytest.mark.slow
def test_outputs_and_reasons_in_the_gradebook_hold_no_hidden_test(left):
    course, _ = left
    for student in ANSWERS:
        path = course.folder('autograded', student, TOY) / f'{TOY}.ipynb'
        cells = nbformat.read(path, as_version=4).cells
        sources = str([cell.source for cell in cells])
        assert set(found_in(sources)) == set(CANARIES)  # so found_in finds them
        assert found_in(str([(c.get('outputs'), c.metadata) for c in cells])) == []
