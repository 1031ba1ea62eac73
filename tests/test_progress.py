"""Exercises that passed in Validate: the file that stores them, and the contents page."""

import json
import shutil
from concurrent.futures import ThreadPoolExecutor

import nbformat
import pytest
from answered import ROOT, answered
from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.lessons.exercises import find_exercises
from my_robot_basics.validate.lessons.lesson import read_lesson
from my_robot_basics.validate.progress.passed_answers import (
    MOST_OF_ONE,
    NewerFile,
    answer_of,
    default_path,
    read_passes,
    record,
)
from my_robot_basics.validate.progress.progress import main, read_progress
from my_robot_basics.validate.progress.remembering import has_passed, remember
from my_robot_basics.validate.reports.report import CheckFeedback, ExerciseFeedback, Report

LESSON = '02_joint_state'
NAME = 'to_joint_state'


@pytest.fixture
def file(tmp_path, monkeypatch):
    """A student's file, which is not there yet."""
    monkeypatch.setenv('JUPYTER_DATA_DIR', str(tmp_path / 'data'))
    return default_path()


@pytest.fixture
def page(tmp_path):
    """A contents page with one answered lesson beside it."""
    folder = tmp_path / 'notebooks'
    answered(LESSON, folder / LESSON)
    shutil.copy(ROOT / 'notebooks/index.ipynb', folder)
    return folder / 'index.ipynb'


def notebook_of(page, lesson=LESSON):
    return page.parent / lesson / f'{lesson}.ipynb'


def answer_in(notebook, name=NAME):
    cells = read_lesson(notebook).notebook
    (exercise,) = [each for each in find_exercises(cells) if each.name == name]
    return answer_of(cells, exercise, notebook.parent)


def passes_in(file, notebook):
    return record(file, notebook.stem, {NAME: (answer_in(notebook), True)}, notebook)


def state(page, file, name=NAME):
    shown = [each.exercises for each in read_progress(page, file).lessons]
    return {each: found for exercises in shown for each, found in exercises.items()}[name]


def edit(notebook, cell_id, change):
    content = nbformat.read(notebook, as_version=4)
    (cell,) = [cell for cell in content.cells if cell.id == cell_id]
    cell.source = change(cell.source)
    nbformat.write(content, notebook)


# --- the page ------------------------------------------------------------------------------------


def test_no_exercise_has_passed_on_a_fresh_copy(page, file):
    assert state(page, file) == 'open'
    assert state(page, file, 'explain_counts') == 'by hand'
    assert not file.exists()


def test_an_exercise_counts_as_passed_only_with_the_answer_that_passed(page, file):
    notebook = notebook_of(page)
    before = notebook.read_bytes()
    assert passes_in(file, notebook) == ()
    assert state(page, file) == 'passed'
    assert 'Passed in Validate: 1 of ' in read_progress(page, file).summary
    edit(notebook, NAME, lambda source: source.replace('radians(theta1_deg)', 'theta1_deg'))
    assert state(page, file) == 'changed'
    assert 'Passed in Validate: 0 of ' in read_progress(page, file).summary
    notebook.write_bytes(before)
    assert state(page, file) == 'passed'


def test_a_changed_check_resets_a_passed_exercise_and_changed_text_does_not(page, file):
    notebook = notebook_of(page)
    passes_in(file, notebook)
    edit(notebook, 'contract', lambda source: source + '\n\nMy notes.')
    edit(notebook, NAME, lambda source: source + '\n')
    assert state(page, file) == 'passed'
    edit(notebook, 'radians', lambda source: source + '\n# another release checks more')
    assert state(page, file) == 'changed'


def test_line_ends_of_windows_change_no_check_and_no_answer(page, file):
    """Grading reads them like the released cells; Validate called each check changed."""
    notebook = notebook_of(page)
    passes_in(file, notebook)
    cells = json.loads(notebook.read_text('utf-8'))
    for cell in cells['cells']:
        cell['source'] = ''.join(cell['source']).replace('\n', '\r\n')
    notebook.write_text(json.dumps(cells), 'utf-8')
    assert read_lesson(notebook).altered == frozenset()
    assert state(page, file) == 'passed'


def test_an_exercise_that_failed_later_is_no_longer_passed(page, file):
    notebook = notebook_of(page)
    passes_in(file, notebook)
    record(file, LESSON, {NAME: (answer_in(notebook), False)}, notebook)
    assert state(page, file) == 'open'


def test_another_edition_and_a_new_copy_of_the_course_show_passed_exercises(page, file, tmp_path):
    notebook = notebook_of(page)
    passes_in(file, notebook)
    chinese = page.parent / 'zh_CN' / 'index.ipynb'
    shutil.copytree(ROOT / f'notebooks/zh_CN/{LESSON}', chinese.parent / LESSON)
    shutil.copy(ROOT / 'notebooks/zh_CN/index.ipynb', chinese)
    assert state(chinese, file) == 'passed'  # in English, where the answer is unchanged
    newer = tmp_path / 'newer'
    shutil.copytree(page.parent, newer)
    shutil.rmtree(page.parent)  # the older one is gone
    assert state(newer / 'index.ipynb', file) == 'passed'
    edit(notebook_of(newer / 'index.ipynb'), NAME, lambda source: 'def to_joint_state(): ...')
    assert state(newer / 'index.ipynb', file) == 'changed'


def test_an_exercise_stays_passed_if_the_notebook_is_missing_or_damaged(page, file):
    passes_in(file, notebook_of(page))
    notebook_of(page).write_text('{')
    assert state(page, file) == 'passed'
    notebook_of(page).unlink()
    assert state(page, file) == 'passed'


@pytest.mark.parametrize('content', [b'{', b'[]', b'{"metadata": {}}', b'\xff'])
def test_a_file_that_is_not_the_contents_page_is_refused(tmp_path, file, content):
    other = tmp_path / 'other.ipynb'
    other.write_bytes(content)
    with pytest.raises(CourseError, match='is not the contents page'):
        read_progress(other, file)


def test_a_package_that_is_the_answer_counts_with_all_its_files(page, file):
    lesson = '12_package'
    shutil.copytree(ROOT / 'notebooks' / lesson, page.parent / lesson)
    notebook = notebook_of(page, lesson)
    package = notebook.parent / 'arm_player'
    (package / 'arm_player').mkdir(parents=True)
    (package / 'setup.py').write_text('...')
    record(file, lesson, {'arm_player': (answer_in(notebook, 'arm_player'), True)}, notebook)
    (package / '__pycache__').mkdir()
    (package / '__pycache__/setup.pyc').write_text('what Python leaves')
    assert state(page, file, 'arm_player') == 'passed'
    node = package / 'arm_player/player.py'
    node.write_text('# new')
    assert state(page, file, 'arm_player') == 'changed'
    node.unlink()
    assert state(page, file, 'arm_player') == 'passed'
    (package / 'setup.py').write_text('other')
    assert state(page, file, 'arm_player') == 'changed'


# --- the file ------------------------------------------------------------------------------------


def test_the_file_is_in_the_data_folder_of_the_user_and_contains_no_answer(page, file, tmp_path):
    passes_in(file, notebook_of(page))
    assert file == tmp_path / 'data/my_robot_basics/passed_answers.json'
    assert [path.name for path in file.parent.iterdir()] == [file.name]
    data = json.loads(file.read_text())
    assert data['schema'] == 1
    (kept,) = data['lessons'][LESSON][NAME]
    assert kept.keys() == {'answer', 'notebook', 'passed_at'}
    assert 'def to_joint_state' not in file.read_text()


DAMAGED = {
    'half a file': b'{"schema": 1, "lessons": {"02_jo',
    'nothing': b'',
    'another thing': b'[1, 2]',
    'a field that is missing': b'{"schema": 1, "lessons": {"a": {"b": [{"answer": "x"}]}}}',
    'a text for a list': b'{"schema": 1, "lessons": {"a": 3}}',
    'too deep': b'[' * 100_000,
    'bytes': b'\x00\xff\xfe',
}


@pytest.mark.parametrize('content', DAMAGED.values(), ids=DAMAGED)
def test_a_damaged_file_is_reported_kept_and_replaced(page, file, content):
    file.parent.mkdir(parents=True)
    file.write_bytes(content)
    shown = read_progress(page, file)
    assert 'is damaged, so your progress is not shown' in shown.notes[0]
    assert file.read_bytes() == content  # reading alone does not change the file
    (note,) = passes_in(file, notebook_of(page))
    aside = file.with_name('passed_answers.damaged-1.json')
    assert f'it is kept as {aside}' in note
    assert aside.read_bytes() == content
    assert state(page, file) == 'passed'
    file.write_bytes(content)
    passes_in(file, notebook_of(page))
    assert file.with_name('passed_answers.damaged-2.json').exists()


def test_a_file_of_a_newer_version_is_left_unchanged(page, file):
    file.parent.mkdir(parents=True)
    newer = b'{"schema": 2, "somewhere": "else"}'
    file.write_bytes(newer)
    with pytest.raises(NewerFile):
        read_passes(file)
    (note,) = passes_in(file, notebook_of(page))
    assert 'was written by a newer version of the course' in note
    assert file.read_bytes() == newer
    assert read_progress(page, file).notes == (note,)


def test_a_file_that_cannot_be_written_is_reported_without_an_error(page, file):
    file.parent.parent.mkdir()
    file.parent.write_text('a file in the way')
    (note,) = passes_in(file, notebook_of(page))
    assert 'could not be written' in note
    assert 'the checks are not affected' in note


def test_concurrent_writers_lose_no_passed_exercise(page, file):
    names = [f'exercise_{number}' for number in range(24)]

    def write(name):
        record(file, LESSON, {name: ('0' * 12, True)}, notebook_of(page))

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write, names))
    assert sorted(read_passes(file)[LESSON]) == sorted(names)


def test_only_the_latest_passed_answers_of_an_exercise_are_kept(page, file):
    for number in range(MOST_OF_ONE + 5):
        record(file, LESSON, {NAME: (str(number), True)}, notebook_of(page))
    kept = [each.answer for each in read_passes(file)[LESSON][NAME]]
    assert kept == [str(number) for number in range(5, MOST_OF_ONE + 5)]


# --- reports -------------------------------------------------------------------------------------


def report_of(*outcomes, answer='abc'):
    checks = tuple(
        CheckFeedback(f'check{i}', 'A check', 1.0, outcome, is_partly_hidden=False)
        for i, outcome in enumerate(outcomes)
    )
    return Report(f'{LESSON}.ipynb', (ExerciseFeedback(NAME, (), checks, answer),), ())


@pytest.mark.parametrize(
    ('outcomes', 'passed'),
    [
        (['passed', 'passed'], True),
        (['passed', 'at grading'], True),
        (['passed', 'failed'], False),
        (['partial'], False),
        (['passed', 'not checked'], None),
        (['at grading'], None),
        (['by hand'], None),
    ],
)
def test_an_exercise_passes_when_all_checks_that_can_run_pass(outcomes, passed):
    assert has_passed(report_of(*outcomes).parts[0]) is passed


def test_a_passed_report_is_recorded_and_an_unknown_outcome_is_not(page, file):
    notebook = notebook_of(page)
    remember(report_of('not checked'), notebook)
    assert not file.exists()
    report = report_of('passed', answer=answer_in(notebook))
    assert remember(report, notebook) == report
    assert state(page, file) == 'passed'
    remember(report_of('not checked', answer=answer_in(notebook)), notebook)
    assert state(page, file) == 'passed'


# --- a terminal ----------------------------------------------------------------------------------


def test_the_terminal_shows_passed_exercises(page, file, capsys):
    passes_in(file, notebook_of(page))
    assert main([str(page)]) == 0
    said = capsys.readouterr().out
    assert said.startswith('Passed in Validate: 1 of ')
    assert '  ✓ to_joint_state (passed)\n' in said
    assert '  ○ reach (not passed yet)\n' in said
    assert '  … explain_counts (a person reads it)\n' in said
    assert said.endswith('This is kept on this computer alone. You get your points at grading.\n')


def test_the_usage_names_the_command_that_is_typed(page, file, capsys):
    with pytest.raises(SystemExit):
        main([str(page), 'xx'])
    assert capsys.readouterr().err == (
        'usage: ./course progress [-h] [--language LANGUAGE]\n'
        './course progress: error: unrecognized arguments: xx\n'
    )


def test_the_terminal_reports_a_missing_contents_page(tmp_path, file, capsys):
    assert main([str(tmp_path / 'index.ipynb')]) == 2
    assert 'cannot be read: No such file' in capsys.readouterr().err
