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
    """The texts that were checked; none is cached in memory before the test."""
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


def test_each_version_of_a_lesson_is_checked_once(checked, tmp_path):
    as_nbformat_does = nbformat.reads(lesson(), as_version=4)
    checked.clear()
    for _ in range(2):
        assert read_anew(lesson(), tmp_path) == as_nbformat_does
    assert len(checked) == 1
    assert read_anew(lesson(source='2'), tmp_path).cells[0].source == '2'
    assert read_anew(lesson(), tmp_path).cells[0].source == '1'
    assert len(checked) == 2


@pytest.mark.parametrize('kept', ['', '{}', '[1, null]', '["' + '0' * 64 + '"]'])
def test_a_damaged_record_of_checked_texts_is_written_anew(kept, checked, tmp_path):
    (tmp_path / KEPT).write_text(kept)
    for _ in range(2):
        assert read_anew(lesson(), tmp_path).cells[0].source == '1'
    assert len(checked) == 1


def test_the_oldest_checked_text_is_forgotten_when_the_record_is_full(
    checked, tmp_path, monkeypatch
):
    monkeypatch.setattr(lesson_text, 'MOST_KEPT', 2)
    for source in ('1', '2', '3', '1'):
        read_anew(lesson(source=source), tmp_path)
    assert len(checked) == 4
    assert len(json.loads((tmp_path / KEPT).read_text())) == 2


def test_reading_a_lesson_does_not_make_a_gradebook_folder(checked, tmp_path):
    for _ in range(2):
        read_anew(lesson(), tmp_path / 'gradebook')
    assert len(checked) == 2
    assert not (tmp_path / 'gradebook').exists()


def test_a_change_to_a_lesson_that_was_read_does_not_affect_later_reads(checked, tmp_path):
    read_anew(lesson(), tmp_path).cells[0].source = 'changed'
    assert read_lesson(lesson(), tmp_path).cells[0].source == '1'


@pytest.mark.filterwarnings('ignore:Cell is missing an id')
def test_a_missing_cell_id_is_added_at_each_read(checked, tmp_path):
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
def test_a_text_that_is_not_a_notebook_is_refused_at_each_read(text, told, checked, tmp_path):
    for _ in range(2):
        with pytest.raises(ValueError, match=told):
            read_anew(text, tmp_path)


@pytest.mark.parametrize('verb', [pytest.param('grade', marks=pytest.mark.starts), 'release'])
def test_grade_and_release_name_a_lesson_that_is_not_a_notebook(verb, tmp_path, capsys):
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


def test_a_lesson_that_git_could_not_merge_is_refused_with_the_way_to_choose(tmp_path, capsys):
    course = released_course(tmp_path)
    path = course.source_path(TOY)
    ours = path.read_text()
    path.write_text(ours.replace('{', '{\n<<<<<<< HEAD\n', 1) + '\n=======\n>>>>>>> theirs\n')
    assert main(['release'], course=course) == 1
    assert f"git checkout --ours '{path}'" in capsys.readouterr().err


def test_release_replaces_a_released_lesson_that_is_not_a_notebook(tmp_path, capsys):
    course = released_course(tmp_path)
    path = course.release_path(TOY)
    path.write_text('{')
    with pytest.raises(CourseError, match=rf'{TOY}.ipynb is not a notebook: .*; run ./course rel'):
        course.release(TOY)
    assert main(['release', TOY], course=course) == 0
    assert course.release(TOY).cells
