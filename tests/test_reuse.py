import os
import shutil
import sqlite3
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import nbformat
import pytest
from course_maker import TOY, answered, executed, released_course, submit, toy_lesson, write_source
from nbformat.v4 import new_markdown_cell
from nbgrader.api import Gradebook
from sqlalchemy import event
from sqlalchemy.engine import Engine
from stand_in import Here, stand_in

from grader.__main__ import main
from grader.common import versions
from grader.course import ROOT
from grader.grade import grade_all
from grader.grading import Grading
from grader.judging.execute import Execution
from grader.notebook import submission
from grader.notebook.restore import KEY
from grader.report.progress_table import changes
from grader.sandbox import limits
from grader.storage import reuse
from grader.storage.records import records
from grader.storage.submitted import find_submissions

RIGHT = 'def double(x):\n    return 2 * x'
WRONG = 'def double(x):\n    return x + 1'


@pytest.fixture
def looked():
    """The answers that were run, in their order."""
    return []


@pytest.fixture
def course(tmp_path, monkeypatch, looked):
    """A course of its own; in the rooms' place, a look at the answer's text."""

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
        looked.append(answer)
        reason = '?' if 'no room' in answer else '' if '2 * x' in answer else 'count again'
        if 'harder' in ''.join(cell.source for cell in notebook.cells):
            reason = reason or 'not good enough'
        reasons = {'double-check': '', 'double-hidden': reason}
        return Execution(notebook=executed(notebook, reasons), verdicts=(), notes=())

    stand_in(look, monkeypatch)
    return released_course(tmp_path)


def rows_of(course, **options):
    return {row.student_id: row for row in grade_all(course, find_submissions(course), **options)}


def score_by_hand(course, student, points):
    with Gradebook(course.db_url) as book:
        grade = book.find_grade('explain', TOY, TOY, student)
        grade.manual_score, grade.needs_manual_grade = points, False
        book.db.commit()


def graded_path(course, student):
    return course.folder('autograded', student, TOY) / f'{TOY}.ipynb'


def test_what_has_not_changed_is_not_run_again_and_says_so(course, looked):
    submit(course, 'ada', answered(course, RIGHT, explained='so'))
    submit(course, 'bob', answered(course, WRONG))
    submit(course, 'eve', b'')
    first = rows_of(course)
    assert not any(row.reused for row in first.values())
    kept = graded_path(course, 'ada').read_bytes()
    again = rows_of(course)
    assert len(looked) == 2
    for name, row in again.items():
        assert row.reused
        assert row.seconds is None
        assert row.reason == first[name].reason
        assert row.stored.score == row.stored.former == first[name].stored.score
        assert row.stored.pending == first[name].stored.pending
    assert graded_path(course, 'ada').read_bytes() == kept


def test_what_was_read_once_is_not_read_again(course, looked, monkeypatch):
    submit(course, 'ada', answered(course, RIGHT))
    submit(course, 'eve', b'')
    rows_of(course)
    read = []
    does = submission.read_notebook
    monkeypatch.setattr(
        submission, 'read_notebook', lambda path: read.append(path.parts[-3]) or does(path)
    )
    assert all(row.reused for row in rows_of(course).values())
    assert read == ['eve']  # why it can't be read may be another reason now
    submit(course, 'ada', answered(course, WRONG))
    assert not rows_of(course)['ada'].reused
    assert read == ['eve', 'ada', 'eve']
    assert len(looked) == 2


def test_a_worker_begins_before_lessons_are_read_where_there_is_work_for_it(
    course, looked, monkeypatch
):
    done = []
    does = Grading.prepare
    monkeypatch.setattr(
        Grading, 'prepare', lambda self, name: done.append('prepared') or does(self, name)
    )
    monkeypatch.setattr(Here, 'begin', lambda self: done.append('begun'))
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    assert done[:2] == ['begun', 'prepared']
    done.clear()
    rows_of(course)
    assert done == ['prepared']
    done.clear()
    rows_of(course, force=True)
    assert done[:2] == ['begun', 'prepared']


@pytest.mark.parametrize(
    'damage',
    [
        '{"nbformat": 4, "x": "KEY',
        '["KEY"]',
        '{"x": "KEY"}',
        '{"nbformat": 4, "nbformat_minor": 5, "x": "KEY"}',
        '{"nbformat": 4, "nbformat_minor": 5, "cells": 1, "metadata": {"x": "KEY"}}',
        '{"nbformat": 4, "nbformat_minor": 5, "cells": [], "metadata": {"x": "KEY"}}',
        '{"nbformat": 4, "nbformat_minor": 5, "cells": [1], "metadata": []}  KEY',
    ],
)
def test_a_damaged_result_is_made_again(course, looked, damage):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    path = graded_path(course, 'ada')
    whole = path.read_text(encoding='utf-8')
    key = nbformat.reads(whole, as_version=4).metadata[KEY]['graded_under']
    path.write_text(damage.replace('KEY', key))
    row = rows_of(course)['ada']
    assert (row.reused, row.stored.score, len(looked)) == (False, 3.0, 2)
    assert path.read_text(encoding='utf-8') == whole


def test_a_result_that_holds_takes_few_questions_to_the_database(course, looked):
    questions = []

    @event.listens_for(Engine, 'before_cursor_execute')
    def count(*_):
        questions.append(1)

    try:
        asked = []
        for students in (['a', 'b'], ['c', 'd']):
            for name in students:
                submit(course, name, answered(course, RIGHT))
            rows_of(course)
            questions.clear()
            assert all(row.reused for row in rows_of(course).values())
            asked.append(len(questions))
    finally:
        event.remove(Engine, 'before_cursor_execute', count)
    assert 0 < (asked[1] - asked[0]) / 2 <= 3


def test_force_runs_it_again(course, looked):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    assert not rows_of(course, force=True)['ada'].reused
    assert len(looked) == 2


def another_answer(course, monkeypatch):
    submit(course, 'ada', answered(course, WRONG))


def a_file_beside_it(course, monkeypatch):
    (course.folder('submitted', 'ada', TOY) / 'helper.py').write_text('x = 1')


def another_time(course, monkeypatch):
    (course.folder('submitted', 'ada', TOY) / 'timestamp.txt').write_text('2026-01-02 03:04 UTC')


def another_lesson(course, monkeypatch):
    lesson = toy_lesson()
    lesson.cells[7].source += '\n# harder'
    write_source(course, lesson)


def points(course, monkeypatch):
    lesson = toy_lesson()
    lesson.cells[6].metadata['nbgrader']['points'] = 3
    write_source(course, lesson)


def a_tag(course, monkeypatch):
    lesson = toy_lesson()
    del lesson.cells[2].metadata['tags']  # a cell that is not run becomes one that is
    write_source(course, lesson)


def a_cells_id(course, monkeypatch):
    lesson = toy_lesson()
    lesson.cells[0].id = 'head'  # students' cells are matched by it
    write_source(course, lesson)


def a_cells_type(course, monkeypatch):
    lesson = toy_lesson()
    code = lesson.cells[5]
    lesson.cells[5] = new_markdown_cell(code.source, id=code.id, metadata=code.metadata)
    write_source(course, lesson)


def another_stub(course, monkeypatch):
    stub = course.release(TOY)
    stub.cells[4].source += '\n# write here'
    nbformat.write(stub, course.release_path(TOY))


def other_machinery(course, monkeypatch):
    monkeypatch.setattr(reuse, 'machinery', lambda: 'another rclpy')


def no_sandbox(course, monkeypatch):
    monkeypatch.setattr(Here, 'require_isolation', lambda self, trust_students: False)


def a_notebook_of_nbgraders_own(course, monkeypatch):
    notebook = nbformat.read(graded_path(course, 'ada'), as_version=4)
    del notebook.metadata[KEY]
    nbformat.write(notebook, graded_path(course, 'ada'))


def a_damaged_notebook(course, monkeypatch):
    path = graded_path(course, 'ada')
    path.write_bytes(path.read_bytes()[:-9])


@pytest.mark.parametrize(
    'change',
    [
        another_answer,
        a_file_beside_it,
        another_time,
        another_lesson,
        points,
        a_tag,
        a_cells_id,
        a_cells_type,
        another_stub,
        other_machinery,
        no_sandbox,
        a_notebook_of_nbgraders_own,
        a_damaged_notebook,
    ],
)
def test_whatever_a_result_depends_on_makes_it_new(course, looked, monkeypatch, change):
    monkeypatch.setattr(Here, 'require_isolation', lambda self, trust_students: True)
    submit(course, 'ada', answered(course, RIGHT))
    # a student's own seed is another one for other cells, which would hide what else counts
    rows_of(course, seed='abc')
    assert rows_of(course, seed='abc')['ada'].reused
    change(course, monkeypatch)
    assert not rows_of(course, seed='abc')['ada'].reused
    assert len(looked) == 2


def test_another_name_of_a_file_makes_it_new(course, looked):
    helper = submit(course, 'ada', answered(course, RIGHT)).with_name('helper.py')
    helper.write_text('x = 1')
    rows_of(course)
    helper.rename(helper.with_name('other.py'))
    assert not rows_of(course)['ada'].reused
    assert len(looked) == 2


def test_another_reason_why_a_notebook_cannot_be_read_is_told(course):
    submit(course, 'eve', b'')
    before = rows_of(course)['eve']
    submit(course, 'eve', b'{}')
    row = rows_of(course)['eve']
    assert not row.reused
    assert before.reason != row.reason
    assert 'JSON but not a notebook' in row.reason


def test_another_seed_makes_it_new(course, looked):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    assert not rows_of(course, seed='abc')['ada'].reused
    assert rows_of(course, seed='abc')['ada'].reused
    assert len(looked) == 2


def test_outputs_of_the_lesson_change_nothing(course, looked):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    lesson = toy_lesson()
    lesson.cells[2].outputs = []
    write_source(course, lesson)
    assert rows_of(course)['ada'].reused


def test_the_graders_own_failure_is_never_taken_for_a_result(course, looked):
    submit(course, 'ada', answered(course, '# no room'))
    assert rows_of(course)['ada'].stored.pending
    assert not rows_of(course)['ada'].reused
    assert len(looked) == 2


def test_what_the_gradebook_lost_or_holds_otherwise_is_stored_again_without_running(
    course, looked
):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    with Gradebook(course.db_url) as book:
        book.find_grade('double-hidden', TOY, TOY, 'ada').auto_score = 0.5
        book.db.commit()
    row = rows_of(course)['ada']
    assert (row.stored.former, row.stored.score, row.reused) == (1.5, 3.0, False)
    with Gradebook(course.db_url) as book:
        book.remove_submission(TOY, 'ada')
    row = rows_of(course)['ada']
    assert (row.stored.former, row.stored.score, row.reused) == (None, 3.0, False)
    assert rows_of(course)['ada'].reused
    assert len(looked) == 1


def test_a_persons_score_is_kept_and_not_asked_for_again(course):
    submit(course, 'ada', answered(course, RIGHT, explained='so'))
    rows_of(course)
    score_by_hand(course, 'ada', 1.5)
    row = rows_of(course)['ada']
    assert (row.reused, row.stored.score, row.stored.pending) == (True, 4.5, False)
    with sqlite3.connect(course.gradebook / 'gradebook.db') as database:
        asked = 'select count(*) from grade where needs_manual_grade'
        assert database.execute(asked).fetchone() == (0,)
    assert rows_of(course, force=True)['ada'].stored.score == 4.5


def test_what_lateness_costs_follows_the_file_without_a_run(course, looked):
    path = submit(course, 'ada', answered(course, RIGHT))
    path.with_name('timestamp.txt').write_text('2026-01-02 12:00:00 UTC')
    rows_of(course)
    due = f'[due]\n{TOY} = 2026-01-02T00:00:00Z\n[late]\nper_day = 0.1\n'
    (course.gradebook / 'deadlines.toml').write_text(due)
    row = rows_of(course)['ada']
    assert row.reused
    assert (row.stored.former, row.stored.score) == (3.0, pytest.approx(2.7))
    assert row.stored.late == pytest.approx(0.3)
    assert len(looked) == 1


@pytest.mark.slow
def test_a_lesson_that_was_released_again_grades_its_submissions_again(course, looked, capsys):
    submit(course, 'ada', answered(course, RIGHT, explained='so'))
    submit(course, 'bob', answered(course, WRONG))
    assert main(['grade'], course=course) == 0
    assert 'score changed' not in capsys.readouterr().out
    score_by_hand(course, 'ada', 1.5)
    another_lesson(course, None)
    assert main(['release', TOY], course=course) == 0
    capsys.readouterr()
    assert main(['grade'], course=course) == 0
    out = capsys.readouterr().out
    assert '1 score changed:\n  ada  00_toy  4.5 → 2.5 (-2)\n' in out
    report = sorted((course.gradebook / 'runs').glob('*/report.html'))[-1]
    assert f'Report: {report}\n' in out
    assert '<li>ada  00_toy  4.5 → 2.5 (-2)</li>' in report.read_text(encoding='utf-8')
    assert len(looked) == 4
    by_hand = [r for r in records(course) if r.by_hand]
    assert [(r.student_id, r.grade_id, r.score) for r in by_hand] == [('ada', 'explain', 1.5)]
    assert main(['grade'], course=course) == 0
    assert len(looked) == 4
    assert main(['grade', '--force'], course=course) == 0
    assert len(looked) == 6


def test_only_scores_that_changed_are_listed(course):
    submit(course, 'ada', answered(course, RIGHT))
    submit(course, 'bob', answered(course, WRONG))
    assert changes(rows_of(course).values()) == []
    submit(course, 'bob', answered(course, RIGHT))
    assert changes(rows_of(course).values()) == ['bob  00_toy  1 → 3 (+2)']


@pytest.fixture
def machine(tmp_path, monkeypatch):
    """A machine whose code and packages can be changed; says what its hash is now."""
    grader, robot = tmp_path / 'grader', tmp_path / 'my_robot_basics'
    for folder in (grader / 'forkserver', robot / 'checks'):
        folder.mkdir(parents=True)
        (folder / 'code.py').write_text('1')
    shutil.copy(limits.__file__, grader)
    packages = tmp_path / 'site-packages'
    for name in ('numpy-2.3.0.dist-info', 'rclpy-7.1.5-py3.11.egg-info', 'numpy'):
        (packages / name).mkdir(parents=True)
    monkeypatch.setattr(versions, '__file__', str(grader / 'common' / 'versions.py'))
    monkeypatch.setattr(versions.my_robot_basics, '__file__', str(robot / '__init__.py'))
    monkeypatch.setattr(versions.sysconfig, 'get_path', {'purelib': str(packages)}.get)

    def now():
        versions.machinery.cache_clear()
        return versions.machinery()

    yield SimpleNamespace(
        grader=grader, robot=robot, packages=packages, now=now, patch=monkeypatch
    )
    versions.machinery.cache_clear()


def grader_code(machine):
    (machine.grader / 'forkserver' / 'code.py').write_text('2')


def a_new_module_of_the_grader(machine):
    (machine.grader / 'new.py').touch()


def a_limit(machine):
    table = machine.grader / 'limits.py'
    text = table.read_text()
    table.write_text(text.replace('TIMEOUT_SEC = 1_800.0', 'TIMEOUT_SEC = 900.0', 1))
    assert table.read_text() != text


def code_of_the_robot(machine):
    (machine.robot / 'checks' / 'code.py').write_text('2')


def another_name_of_a_module(machine):
    code = machine.robot / 'checks' / 'code.py'
    code.rename(code.with_name('other.py'))


def another_version(machine):
    numpy = machine.packages / 'numpy-2.3.0.dist-info'
    numpy.rename(numpy.with_name('numpy-2.3.1.dist-info'))


def one_package_more(machine):
    (machine.packages / 'new-1.dist-info').mkdir()


def one_package_less(machine):
    (machine.packages / 'rclpy-7.1.5-py3.11.egg-info').rmdir()


def another_python(machine):
    machine.patch.setattr(versions.platform, 'python_version', lambda: '3.99')


def another_processor(machine):
    machine.patch.setattr(versions.platform, 'machine', lambda: 'pdp11')


@pytest.mark.parametrize(
    'change',
    [
        grader_code,
        a_new_module_of_the_grader,
        a_limit,
        code_of_the_robot,
        another_name_of_a_module,
        another_version,
        one_package_more,
        one_package_less,
        another_python,
        another_processor,
    ],
)
def test_the_hash_of_the_machinery_is_another_one_after(machine, change):
    before = machine.now()
    assert machine.now() == before
    change(machine)
    assert machine.now() != before


def test_what_python_writes_beside_code_and_what_leads_nowhere_change_no_hash(machine):
    before = machine.now()
    (machine.robot / '__pycache__').mkdir()
    (machine.robot / '__pycache__' / 'code.pyc').write_text('1')
    (machine.robot / '.#code.py').symlink_to('who@a-machine.1')  # Emacs locks what it edits
    (machine.robot / 'itself').symlink_to(machine.robot)
    assert machine.now() == before


def test_the_order_in_which_a_folder_tells_what_is_in_it_changes_no_hash(machine, monkeypatch):
    before, scandir = machine.now(), os.scandir
    monkeypatch.setattr(
        versions.os, 'scandir', lambda folder: nullcontext([*scandir(folder)][::-1])
    )
    assert machine.now() == before


def test_the_hash_holds_this_very_grader_and_robot():
    folders = {Path(versions.__file__).parents[1], Path(versions.my_robot_basics.__file__).parent}
    assert folders == {ROOT / 'grader', ROOT / 'my_robot_basics' / 'my_robot_basics'}
    assert limits.__file__ in versions._code(str(ROOT / 'grader'))
