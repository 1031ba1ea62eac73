import copy
import csv
import json
import os
import shutil
import sqlite3
import threading
from dataclasses import replace
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, executed, submit, toy_lesson, write_source
from nbgrader.api import Gradebook
from sqlalchemy import event
from sqlalchemy.engine import Engine
from stored_grades import RIGHT, grade, graded_with

from grader.common.errors import CourseError
from grader.course import Course
from grader.export.scores import COLUMNS, write_scores
from grader.notebook.restore import KEY, restore
from grader.notebook.submission import read_submission
from grader.storage import gradebook
from grader.storage import records as records_module
from grader.storage.gradebook import recover, store
from grader.storage.pipeline import make_sanitized_template, make_unanswered, sanitize_restored
from grader.storage.records import records, verdicts
from grader.storage.registering import register
from grader.storage.submission_rows import SubmissionRows


@pytest.fixture
def course(released, tmp_path):
    """The released lesson with a gradebook of its own, in which nothing is graded."""
    shutil.copytree(released.gradebook, tmp_path / 'gradebook')  # making a database takes long
    return Course(root=released.root, gradebook=tmp_path / 'gradebook')


def by_cell(course, student):
    return {r.grade_id: r for r in records(course) if r.student_id == student}


def test_an_assignment_is_registered_once_in_an_empty_gradebook(released, tmp_path):
    course = Course(root=released.root, gradebook=tmp_path / 'empty')
    assert register(course, TOY)
    assert not register(course, TOY)
    with Gradebook(course.db_url) as book:
        assert {c.name: c.max_score for c in book.find_notebook(TOY, TOY).grade_cells} == {
            'double-check': 1.0,
            'double-hidden': 2.0,
            'explain': 2.0,
        }
        assert 'canary' in book.find_source_cell('double-hidden', TOY, TOY).source


def test_a_changed_check_is_registered_again_and_scores_stay(course, released):
    grade(course, 'ada', {})
    changed = toy_lesson()
    changed.cells[6].source += '  # clearer'
    write_source(course, changed)
    try:
        assert register(course, TOY)
        assert by_cell(course, 'ada')['double-check'].score == 1.0
        changed.cells[6].metadata['nbgrader']['grade_id'] = 'renamed'
        write_source(course, changed)
        with pytest.raises(CourseError, match=r'new cells: renamed; gone: double-check.*: give'):
            register(course, TOY)
        more = toy_lesson()
        more.cells.append(copy.deepcopy(more.cells[6]))
        more.cells[-1].id = more.cells[-1].metadata['nbgrader']['grade_id'] = 'one_more'
        write_source(course, more)
        with pytest.raises(CourseError, match=r'new cells: one_more; gone: none.*: take the'):
            register(course, TOY)
    finally:
        write_source(course, toy_lesson())


def test_scores_follow_the_verdicts(course):
    stored = grade(
        course, 'ada', {'double-hidden': 'expected 42, saw 41: count again'}, explained='so'
    )
    assert (stored.score, stored.max_score, stored.former, stored.pending) == (
        1.0,
        5.0,
        None,
        True,
    )
    assert stored.reason == 'expected 42, saw 41: count again'
    cells = by_cell(course, 'ada')
    assert [(name, r.score) for name, r in cells.items()] == [
        ('double-check', 1.0),
        ('double-hidden', 0.0),
        ('explain', None),
    ]


def test_an_unchanged_written_answer_is_scored_zero_automatically(course):
    grade(course, 'ada', {})
    assert by_cell(course, 'ada')['explain'].score == 0.0


def test_the_graders_own_failure_waits_for_a_person(course):
    stored = grade(course, 'ada', {'double-check': '?'})
    assert stored.pending
    assert by_cell(course, 'ada')['double-check'].score is None


def test_a_grade_cell_without_a_verdict_never_earns_points(course):
    submit(course, 'ada', answered(course, RIGHT))
    submission = read_submission(
        course.folder('submitted', 'ada', TOY), student_id='ada', assignment=TOY
    )
    register(course, TOY)
    silent = sanitize_restored(
        course, TOY, restore(submission.notebook, course.template(TOY)).notebook
    )
    assert store(course, submission, silent).pending
    assert by_cell(course, 'ada')['double-check'].score is None


def test_grading_again_keeps_a_score_that_was_given_by_hand(course):
    first = grade(course, 'ada', {'double-check': 'no'}, explained='so')
    with Gradebook(course.db_url) as book:
        book.find_grade('explain', TOY, TOY, 'ada').manual_score = 1.5
        book.find_comment('explain', TOY, TOY, 'ada').manual_comment = 'well put'
        book.db.commit()
    again = grade(course, 'ada', {'double-check': 'no'}, explained='so')
    assert (first.score, again.former, again.score) == (2.0, 3.5, 3.5)
    explained = by_cell(course, 'ada')['explain']
    assert (explained.score, explained.by_hand, explained.comment) == (1.5, True, 'well put')
    assert len(records(course)) == 3


def test_submitted_files_are_only_read(course):
    path = submit(course, 'ada', answered(course, RIGHT))
    path.with_name('helper.py').write_text('x = 1')
    path.with_name('timestamp.txt').write_text('2026-01-02 03:04:05 UTC')
    before = {p: (p.read_bytes(), p.stat().st_mtime_ns) for p in path.parent.iterdir()}
    grade_again = read_submission(path.parent, student_id='ada', assignment=TOY)
    register(course, TOY)
    restored = sanitize_restored(
        course, TOY, restore(grade_again.notebook, course.template(TOY)).notebook
    )
    store(course, grade_again, executed(restored, {}))
    assert before == {p: (p.read_bytes(), p.stat().st_mtime_ns) for p in path.parent.iterdir()}
    kept = course.folder('autograded', 'ada', TOY)
    assert sorted(p.name for p in kept.iterdir()) == [f'{TOY}.ipynb', 'helper.py', 'timestamp.txt']
    with Gradebook(course.db_url) as book:
        assert str(book.find_submission(TOY, 'ada').timestamp) == '2026-01-02 03:04:05'


def test_an_invalid_timestamp_is_noted(course):
    path = submit(course, 'ada', answered(course, RIGHT))
    path.with_name('timestamp.txt').write_text('yesterday evening')
    grade(course, 'ada', {})
    kept = nbformat.read(course.folder('autograded', 'ada', TOY) / f'{TOY}.ipynb', as_version=4)
    assert 'timestamp.txt holds no date' in kept.metadata[KEY].notes[0]


def test_a_storing_that_fails_half_way_changes_nothing(course, monkeypatch):
    grade(course, 'ada', {})
    bad = answered(course, RIGHT)
    found = SubmissionRows.find_grade

    def fails_late(self, cell, *where):
        if cell == 'explain':
            raise sqlite3.OperationalError('disk full')
        return found(self, cell, *where)

    monkeypatch.setattr(SubmissionRows, 'find_grade', fails_late)
    with pytest.raises(sqlite3.OperationalError):
        grade(course, 'ada', {'double-check': 'no', 'double-hidden': 'no'}, notebook=bad)
    with pytest.raises(sqlite3.OperationalError):
        grade(course, 'bob', {}, notebook=bad)
    monkeypatch.undo()
    assert by_cell(course, 'ada')['double-check'].score == 1.0
    assert not by_cell(course, 'bob')


class Killed(BaseException):
    """As with SIGKILL: none of our code can handle it."""


def kill_at(monkeypatch, step, when):
    """Raise Killed before or after a step."""
    place = {'replace': os, 'store_scores': gradebook, 'unlink': Path}[step]
    does = getattr(place, step)

    def done(*arguments):
        if when == 'after':
            does(*arguments)
        raise Killed

    monkeypatch.setattr(place, step, done)


@pytest.mark.parametrize(
    ('step', 'when', 'left'),
    [
        ('replace', 'before', 0),  # nothing has begun
        ('replace', 'after', 1),
        ('store_scores', 'before', 1),
        ('store_scores', 'after', 1),  # the scores are stored, and the notebook is not there
        ('unlink', 'before', 1),
        ('unlink', 'after', 0),  # all is stored
    ],
)
def test_an_interrupted_storing_is_completed_by_the_next_reading(
    course, monkeypatch, step, when, left
):
    grade(course, 'ada', {'double-check': 'no'})
    with monkeypatch.context() as patch:
        kill_at(patch, step, when)
        with pytest.raises(Killed):
            grade(course, 'ada', {'double-hidden': 'not that'})
    assert len(list(course.gradebook.glob('autograded/*/*/.*.begun'))) == left
    cells = by_cell(course, 'ada')
    stored = (cells['double-check'].score, cells['double-hidden'].score)
    assert stored == ((0.0, 2.0) if (step, when) == ('replace', 'before') else (1.0, 0.0))
    said = verdicts(course, 'ada', TOY)
    assert ('no' if stored[1] else 'not that') in {said[name].reason for name in cells}
    kept = course.folder('autograded', 'ada', TOY)
    assert [p.name for p in kept.iterdir() if p.suffix != '.new'] == [f'{TOY}.ipynb']


def test_a_result_that_is_completed_later_is_reported_with_its_former_score(
    course, monkeypatch, capsys
):
    """The next run finds it stored, and calls it unchanged."""
    grade(course, 'ada', {'double-check': 'no'})
    with monkeypatch.context() as patch:
        kill_at(patch, 'store_scores', 'before')
        with pytest.raises(Killed):
            grade(course, 'ada', {'double-hidden': 'not that'})
    recover(course)
    said = capsys.readouterr().err
    assert said.startswith(f'ada  {TOY}  2 → 1 of ')
    assert 'an earlier run ended while it stored this result' in said
    recover(course)
    assert capsys.readouterr().err == ''


def test_a_begun_result_that_cannot_be_stored_is_reported_and_discarded(course, caplog):
    grade(course, 'ada', {})
    kept = course.folder('autograded', 'ada', TOY)
    strange = executed(nbformat.read(kept / f'{TOY}.ipynb', as_version=4), {})
    strange.cells[-2].metadata['nbgrader']['grade_id'] = 'gone'
    (kept / f'.{TOY}.ipynb.begun').write_text(nbformat.writes(strange))
    before = (kept / f'{TOY}.ipynb').read_bytes()
    assert by_cell(course, 'ada')['double-hidden'].score == 2.0
    assert 'is not stored' in caplog.text
    assert [(p.name, p.read_bytes()) for p in kept.iterdir()] == [(f'{TOY}.ipynb', before)]


@pytest.mark.parametrize('student', ['小明', 'Зоя', 'a b', "o'hara", 'x[1]*', '=cmd()', 'é' * 100])
def test_student_names_of_any_alphabet_are_stored_unchanged(course, student):
    submit(course, student, b'no notebook')
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    register(course, TOY)
    stored = store(
        course,
        submission,
        make_unanswered(make_sanitized_template(course, TOY), submission.problem),
    )
    assert (stored.score, stored.pending) == (0.0, False)
    assert 'is not JSON' in stored.reason
    assert folder.with_name(TOY).joinpath(f'{TOY}.ipynb').read_bytes() == b'no notebook'
    assert by_cell(course, student).keys() == {'double-check', 'double-hidden', 'explain'}


def test_scores_are_written_as_a_table_without_spreadsheet_formulas(course):
    grade(course, '=cmd()', {'double-check': '=HYPERLINK("x")', 'double-hidden': '?'})
    grade(course, 'ada', {'double-check': 'expected "a", saw\n\x1b[31mb'})
    with Gradebook(course.db_url) as book:
        book.add_student('zoe')
    path = write_scores(course)
    first = path.read_bytes()
    assert write_scores(course).read_bytes() == first
    rows = list(csv.DictReader(path.read_text('utf-8-sig').splitlines()))
    assert tuple(rows[0]) == COLUMNS
    assert [(r['student_id'], r['grade_id'], r['score'], r['max_score']) for r in rows] == [
        ("'=cmd()", 'double-check', '0.0', '1.0'),
        ("'=cmd()", 'double-hidden', '', '2.0'),
        ("'=cmd()", 'explain', '0.0', '2.0'),
        ('ada', 'double-check', '0.0', '1.0'),
        ('ada', 'double-hidden', '2.0', '2.0'),
        ('ada', 'explain', '0.0', '2.0'),
        ('zoe', 'double-check', '', '1.0'),
        ('zoe', 'double-hidden', '', '2.0'),
        ('zoe', 'explain', '', '2.0'),
    ]
    assert rows[0]['comment'] == '\'=HYPERLINK("x")'
    assert rows[1]['comment'] == 'to be graded by hand; ?'
    assert rows[3]['comment'] == 'expected "a", saw \\x1b[31mb'
    assert first.startswith(b'\xef\xbb\xbf')  # else a spreadsheet shows other letters
    assert rows[6]['comment'] == 'not submitted'
    assert {r['assignment'] for r in rows} == {TOY}


def test_a_large_class_takes_no_more_database_queries_than_a_small_one(course, monkeypatch):
    questions = []

    @event.listens_for(Engine, 'before_cursor_execute')
    def count(*_):
        questions.append(1)

    def questions_with(students):
        with Gradebook(course.db_url) as book:
            for number in students:
                book.add_student(f'student_{number}')
        questions.clear()
        found = records(course)
        return len(questions), {each.student_id for each in found}

    try:
        grade(course, 'ada', {})
        few, _ = questions_with(range(3))
        many, whose = questions_with(range(3, 43))
    finally:
        event.remove(Engine, 'before_cursor_execute', count)
    assert 0 < many <= few
    assert len(whose) == 44
    at_once = records(course)
    assert any(each.submitted for each in at_once)
    monkeypatch.setattr(records_module, 'MOST_ASKED', 10)
    assert records(course) == at_once


def test_a_seed_depends_on_the_student_the_course_and_the_lesson_s_text(
    course, released, tmp_path
):
    seed = course.seed(TOY, 'ada')
    assert int(seed, 16)
    assert seed == course.seed(TOY, 'ada') == course.seeds(TOY)('ada')
    assert (
        len({seed, course.seed(TOY, 'bob'), course.seed(TOY, 'ada"'), course.seed(TOY, '')}) == 4
    )
    assert os.stat(course.gradebook / 'course_secret').st_mode & 0o777 == 0o600
    other = Course(root=course.root, gradebook=tmp_path / 'other')
    assert other.seed(TOY, 'ada') != seed
    lesson = toy_lesson()
    lesson.cells[2].outputs = []
    write_source(course, lesson)
    assert course.seed(TOY, 'ada') == seed
    lesson.cells[7].source += '\n'
    write_source(course, lesson)
    assert course.seed(TOY, 'ada') != seed
    write_source(course, toy_lesson())


def test_threads_that_begin_at_once_agree_on_one_secret(course):
    seeds = []
    threads = [
        threading.Thread(target=lambda: seeds.append(course.seed(TOY, 'ada'))) for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(seeds) == 8
    assert len(set(seeds)) == 1
    assert not list(course.gradebook.glob('.*'))


def test_an_unreadable_submission_is_stored_as_a_notebook_with_a_reason(course):
    submit(course, 'ada', json.dumps({'cells': []}))
    folder = course.folder('submitted', 'ada', TOY)
    submission = read_submission(folder, student_id='ada', assignment=TOY)
    register(course, TOY)
    store(
        course,
        submission,
        make_unanswered(make_sanitized_template(course, TOY), submission.problem),
    )
    kept = nbformat.read(course.folder('autograded', 'ada', TOY) / f'{TOY}.ipynb', as_version=4)
    nbformat.validate(kept)
    assert kept.metadata[KEY].problem == submission.problem
    assert all(r.score == 0.0 for r in by_cell(course, 'ada').values())


def stored(course, student):
    """Return the names of the files in a student's folder in autograded/."""
    kept = course.folder('autograded', student, TOY)
    return sorted(path.name for path in kept.iterdir()) if kept.exists() else []


@pytest.mark.parametrize('name', ['x' * 252 + '.py', 'gone.py'])
def test_no_scores_are_stored_if_an_extra_file_cannot_be_kept(course, name):
    """Otherwise points would be in the database without a notebook or a page."""
    submission, graded = graded_with(course, 'ada')
    file = submission.path.with_name(name)
    if name != 'gone.py':
        file.touch()
    with pytest.raises(OSError, match=r'too long|No such file'):
        store(course, replace(submission, extra_files=(file,)), graded)
    assert not by_cell(course, 'ada')
    assert stored(course, 'ada') == []


def test_no_scores_are_stored_if_a_note_cannot_be_encoded(course):
    submission, graded = graded_with(course, 'ada')
    graded.metadata[KEY].notes = ['the file `x\udcff.py` of 3.0 MB was left out']
    with pytest.raises(UnicodeEncodeError):
        store(course, submission, graded)
    assert not by_cell(course, 'ada')
    assert stored(course, 'ada') == []
