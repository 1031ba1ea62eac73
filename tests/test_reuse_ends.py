"""A result is not used again once anything that it depends on has changed."""

import nbformat
import pytest
from course_maker import TOY, answered, submit, toy_lesson, write_source
from looked_at import RIGHT, WRONG, graded_path, looked_at_course, rows_of, score_by_hand
from nbformat.v4 import new_markdown_cell
from stand_in import Here

from grader.__main__ import main
from grader.notebook.restore import KEY
from grader.storage import reuse
from grader.storage.records import records


@pytest.fixture
def looked():
    """The answers that were run, in their order."""
    return []


@pytest.fixture
def course(tmp_path, monkeypatch, looked):
    return looked_at_course(tmp_path, monkeypatch, looked)


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
    monkeypatch.setattr(reuse, 'software_hash', lambda: 'another rclpy')


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
def test_a_change_of_anything_that_a_result_depends_on_causes_a_new_run(
    course, looked, monkeypatch, change
):
    monkeypatch.setattr(Here, 'require_isolation', lambda self, trust_students: True)
    submit(course, 'ada', answered(course, RIGHT))
    # a student's own seed depends on the cells: its change would hide what else counts
    rows_of(course, seed='abc')
    assert rows_of(course, seed='abc')['ada'].reused
    change(course, monkeypatch)
    assert not rows_of(course, seed='abc')['ada'].reused
    assert len(looked) == 2


def test_a_renamed_file_beside_the_notebook_causes_a_new_run(course, looked):
    helper = submit(course, 'ada', answered(course, RIGHT)).with_name('helper.py')
    helper.write_text('x = 1')
    rows_of(course)
    helper.rename(helper.with_name('other.py'))
    assert not rows_of(course)['ada'].reused
    assert len(looked) == 2


def test_a_new_reason_why_a_notebook_cannot_be_read_is_reported(course):
    submit(course, 'eve', b'')
    before = rows_of(course)['eve']
    submit(course, 'eve', b'{}')
    row = rows_of(course)['eve']
    assert not row.reused
    assert before.reason != row.reason
    assert 'JSON but not a notebook' in row.reason


def test_another_seed_causes_a_new_run(course, looked):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    assert not rows_of(course, seed='abc')['ada'].reused
    assert rows_of(course, seed='abc')['ada'].reused
    assert len(looked) == 2


@pytest.mark.slow
def test_submissions_are_graded_again_after_a_new_release_of_their_lesson(course, looked, capsys):
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
