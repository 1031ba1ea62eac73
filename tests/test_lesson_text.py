"""A lesson is checked once for each version of its text, and faults are reported."""

import json

import nbformat
import pytest
from course_maker import TOY, released_course

from grader.__main__ import main
from grader.common.errors import CourseError
from grader.notebook import lesson_text
from grader.notebook.lesson_text import KEPT, read_lesson


@pytest.fixture
def checked(monkeypatch):
    """How many texts have been checked, by runs that know nothing of each other."""
    lesson_text._packed.cache_clear()
    texts = []

    def validate(notebook, **of_a_part):
        texts.extend([] if of_a_part else [notebook])
        check(notebook, **of_a_part)

    check = nbformat.validate
    monkeypatch.setattr(lesson_text.nbformat, 'validate', validate)
    yield texts
    lesson_text._packed.cache_clear()


def read_anew(text, gradebook):
    lesson_text._packed.cache_clear()
    return read_lesson(text, gradebook)


def lesson(**cell):
    made = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell('1', id='one')])
    made.cells[0].update(cell)
    return json.dumps(made)


def test_a_text_is_checked_once_and_the_next_one_again(checked, tmp_path):
    as_nbformat_does = nbformat.reads(lesson(), as_version=4)
    checked.clear()
    for _ in range(2):
        assert read_anew(lesson(), tmp_path) == as_nbformat_does
    assert len(checked) == 1
    assert read_anew(lesson(source='2'), tmp_path).cells[0].source == '2'
    assert read_anew(lesson(), tmp_path).cells[0].source == '1'
    assert len(checked) == 2


@pytest.mark.parametrize('kept', ['', '{}', '[1, null]', '["' + '0' * 64 + '"]'])
def test_what_is_remembered_may_be_damaged(kept, checked, tmp_path):
    (tmp_path / KEPT).write_text(kept)
    for _ in range(2):
        assert read_anew(lesson(), tmp_path).cells[0].source == '1'
    assert len(checked) == 1


def test_nothing_is_remembered_for_ever(checked, tmp_path, monkeypatch):
    monkeypatch.setattr(lesson_text, 'MOST_KEPT', 2)
    for source in ('1', '2', '3', '1'):
        read_anew(lesson(source=source), tmp_path)
    assert len(checked) == 4
    assert len(json.loads((tmp_path / KEPT).read_text())) == 2


def test_without_a_gradebook_none_is_made(checked, tmp_path):
    for _ in range(2):
        read_anew(lesson(), tmp_path / 'gradebook')
    assert len(checked) == 2
    assert not (tmp_path / 'gradebook').exists()


def test_who_changes_what_was_read_changes_it_for_nobody_else(checked, tmp_path):
    read_anew(lesson(), tmp_path).cells[0].source = 'changed'
    assert read_lesson(lesson(), tmp_path).cells[0].source == '1'


@pytest.mark.filterwarnings('ignore:Cell is missing an id')
def test_what_is_added_to_a_text_is_added_each_time(checked, tmp_path):
    without_id = lesson().replace('"id": "one", ', '')
    for _ in range(2):
        assert read_anew(without_id, tmp_path).cells[0].id
    assert len(checked) == 2


@pytest.mark.parametrize(
    ('text', 'told'),
    [
        ('', 'does not appear to be JSON'),
        ('{', 'does not appear to be JSON'),
        ('[]', "other types than those of a notebook .'list' object has no attribute"),
        ('[' * 100_000, 'RecursionError|maximum recursion depth'),
        (lesson().replace('"nbformat_minor": 5', '"nbformat_minor": "x"'), r'\(AssertionError\)$'),
        (lesson(metadata=[]), r'its parts have other types than those of a notebook \(.+\)$'),
        (lesson(execution_count='x'), r"'x' is not .* \(at cells\.0\.execution_count\)"),
        (lesson(nonsense=1), r"\('nonsense' was unexpected\) \(at cells\.0\)"),
        (
            lesson(cell_type='nonsense', source=100 * 'long '),
            r'^….+ is not valid under any of the given schemas \(at cells\.0\)$',
        ),
    ],
)
def test_what_is_no_notebook_is_refused_each_time(text, told, checked, tmp_path):
    for _ in range(2):
        with pytest.raises(ValueError, match=told):
            read_anew(text, tmp_path)


@pytest.mark.parametrize('verb', [pytest.param('grade', marks=pytest.mark.starts), 'release'])
def test_a_lesson_that_is_no_notebook_is_named(verb, tmp_path, capsys):
    course = released_course(tmp_path)
    folder = course.folder('submitted', 'ada', TOY)
    folder.mkdir(parents=True)
    (folder / f'{TOY}.ipynb').write_bytes(course.release_path(TOY).read_bytes())
    path = course.source_path(TOY)
    damaged = json.loads(path.read_text())
    del damaged['cells'][1]['source']
    path.write_text(json.dumps(damaged))
    assert main([verb], course=course) == 1
    why = "'source' is a required property (at cells.1); undo the last change to it"
    assert capsys.readouterr().err == f'course: {path} is not a notebook: {why}\n'


def test_a_released_lesson_that_is_no_notebook_is_made_anew(tmp_path, capsys):
    course = released_course(tmp_path)
    path = course.release_path(TOY)
    path.write_text('{')
    with pytest.raises(CourseError, match=rf'{TOY}.ipynb is not a notebook: .*; run ./course rel'):
        course.release(TOY)
    assert main(['release', TOY], course=course) == 0
    assert course.release(TOY).cells
