import os
import shutil
import tempfile
from collections import Counter
from pathlib import Path

import pytest
from course_maker import TOY, answered, executed, submit
from nbgrader.api import Gradebook
from stand_in import stand_in

from grader.__main__ import main
from grader.cli.demo import demo
from grader.collect.submission_folders import MAX_DEPTH
from grader.common.errors import CourseError
from grader.course import Course
from grader.grade import MOST_IN_VAIN, grade_all
from grader.grading import CHANGED, GONE
from grader.judging import task
from grader.judging.execute import Execution
from grader.notebook.restore import KEY
from grader.report.progress_table import print_rows
from grader.storage.pipeline import is_undecided
from grader.storage.records import graded_notebook, records
from grader.storage.submitted import find_submissions

RIGHT = 'def double(x):\n    return 2 * x'
UNDECIDED = '? the machine was too busy'
BROKEN = '? the test kernel crashed with SIGABRT'
WRONG = 'def double(x):\n    return x + 1'


@pytest.fixture
def course(released, tmp_path, monkeypatch):
    """A gradebook of its own; no answer is run, the verdict is made from its text.

    A check of an answer with `busy N` can't decide the first N times, one with `breaks it` never.
    """
    times: Counter[str] = Counter()

    async def look(notebook, *, extra_files=(), seed='', trust_students=False):
        answer = next(cell.source for cell in notebook.cells if cell.id == 'double')
        assert len(seed) == 64 or seed == 'abc'
        if 'crash' in answer:
            raise OSError('no room')
        reason = '' if '2 * x' in answer else 'expected 2, saw 3: add it to itself'
        reason = UNDECIDED if times[seed] < int(answer.partition('# busy ')[2] or 0) else reason
        reason = BROKEN if '# breaks it' in answer else reason
        times[seed] += 1
        notebook = executed(notebook, {'double-check': reason, 'double-hidden': reason})
        notebook.metadata[KEY]['seed'] = seed
        return Execution(notebook=notebook, verdicts=(), notes=())

    stand_in(look, monkeypatch)
    gradebook = tmp_path / 'gradebook'
    gradebook.mkdir()
    (gradebook / 'gradebook.db').write_bytes(
        (released.gradebook / 'gradebook.db').read_bytes()  # making a database takes long
    )
    return Course(root=released.root, gradebook=gradebook)


def rows_of(course, **wanted):
    return {row.student_id: row for row in grade_all(course, find_submissions(course, **wanted))}


def give_points(course, student):
    with Gradebook(course.db_url) as book:
        for name in ('double-check', 'double-hidden', 'explain'):
            grade = book.find_grade(name, TOY, TOY, student)
            grade.manual_score, grade.needs_manual_grade = 1.0, False
        book.db.commit()


def test_each_submission_gets_its_row_and_its_scores(course):
    submit(course, 'ada', answered(course, RIGHT))
    submit(course, 'bob', answered(course, WRONG))
    submit(course, '小明', b'')
    rows = rows_of(course)
    assert [(name, row.stored.score) for name, row in rows.items()] == [
        ('ada', 3.0),
        ('bob', 0.0),
        ('小明', 0.0),
    ]
    assert rows['bob'].reason == 'expected 2, saw 3: add it to itself'
    assert 'is empty' in rows['小明'].reason
    assert len(records(course)) == 9


@pytest.mark.parametrize(
    ('content', 'reason'),
    [
        (b'\x00\xff', 'not JSON'),
        (b'[1, 2]', 'not a notebook'),
        (b'{"nbformat": 4, "cells": []}', 'has no cells'),
        (b' ' * 50_000_000, '50 MB'),
        (None, 'there is no file'),
    ],
)
def test_an_unreadable_submission_gets_zero_with_a_reason_and_stays_unchanged(
    course, content, reason
):
    path = submit(course, 'ada', content or b'')
    if content is None:
        path.rename(path.with_name('99_other.ipynb'))
    before = {p: p.read_bytes() for p in path.parent.iterdir()}
    row = rows_of(course)['ada']
    assert reason in row.reason
    assert (row.stored.score, row.stored.pending) == (0.0, False)
    assert before == {p: p.read_bytes() for p in path.parent.iterdir()}


def test_a_notebook_without_an_answer_cell_is_graded_as_one_without_answers(course):
    notebook = answered(course, RIGHT)
    notebook.cells = notebook.cells[:3]
    submit(course, 'ada', notebook)
    assert rows_of(course)['ada'].stored.score == 0.0


def test_misplaced_files_are_reported_and_the_rest_is_graded(course):
    submit(course, 'ada', answered(course, RIGHT, explained='so'))
    submitted = course.folder('submitted', '', '')
    (submitted / 'loose.ipynb').touch()
    (submitted / 'bob').mkdir()
    (submitted / 'bob' / f'{TOY}.ipynb').touch()
    (submitted / 'eve' / '99_other').mkdir(parents=True)
    (submitted / '.DS_Store').touch()
    (submitted / os.fsdecode(b'\xff\xfe') / TOY).mkdir(parents=True)
    submit(course, '<b>', answered(course, RIGHT))
    rows = rows_of(course)
    assert {name: row.reason[:30] for name, row in rows.items()} == {
        'ada': '',
        'bob': "a file where an assignment's f",
        'eve': 'there is no such assignment: e',
        'loose.ipynb': "a file where a student's folde",
        '\udcff\udcfe': "the folder's name is not UTF-8",
        '<b>': "the student's name holds one o",
    }
    assert [name for name, row in rows.items() if row.stored] == ['ada']


def test_the_graders_own_failure_stores_nothing_and_the_next_submission_is_graded(course):
    submit(course, 'ada', answered(course, '# crash'))
    submit(course, 'bob', answered(course, RIGHT))
    rows = rows_of(course)
    assert rows['ada'].reason == 'not graded, the grader failed: OSError: no room'
    assert rows['ada'].stored is None
    assert {record.student_id for record in records(course)} == {'bob'}


def test_one_student_or_assignment_can_be_selected_for_grading(course):
    submit(course, 'ada', answered(course, RIGHT))
    submit(course, 'bob', answered(course, WRONG))
    assert rows_of(course, student_id='bob', assignment=TOY).keys() == {'bob'}
    with pytest.raises(CourseError, match=f'no submission of {TOY} by zoe'):
        find_submissions(course, student_id='zoe', assignment=TOY)
    with pytest.raises(CourseError, match="no assignment '99'"):
        find_submissions(course, assignment='99')


def test_a_check_that_could_not_decide_is_tried_again_at_the_end_of_the_run(course, capsys):
    submit(course, 'ada', answered(course, f'{RIGHT}  # busy 0', explained='so'))
    assert main(['grade'], course=course) == 0
    capsys.readouterr()
    submit(course, 'ada', answered(course, f'{WRONG}  # busy 2', explained='so'))
    submit(course, 'eve', answered(course, RIGHT))
    assert main(['grade'], course=course) == 0
    said = capsys.readouterr().out
    rows = [line.split() for line in said.splitlines() if line.startswith(('ada', 'eve'))]
    assert [row[0] for row in rows] == ['ada', 'eve', 'ada']
    assert '(graded again) (was 3)' in said
    assert f'1 score changed:\n  ada  {TOY}  3 → 0 (-3)' in said
    assert '2 graded, 0 unchanged' in said
    assert 'could not decide' not in said


def test_few_are_graded_again_alone_if_none_of_them_can_be_decided(course):
    for number in range(MOST_IN_VAIN + 2):
        submit(course, f'ada{number}', answered(course, f'{RIGHT}  # busy 9'))
    submit(course, 'eve', answered(course, RIGHT))
    again = [row.student_id for row in grade_all(course, find_submissions(course)) if row.again]
    assert again == [f'ada{number}' for number in range(MOST_IN_VAIN)]


def test_answers_that_break_their_checks_take_nobodys_second_grading(course):
    """They need not be tried again: both attempts at them failed, whatever else was running."""
    for number in range(MOST_IN_VAIN):
        submit(course, f'ada{number}', answered(course, f'{RIGHT}  # breaks it'))
    submit(course, 'eve', answered(course, f'{RIGHT}  # busy 1'))
    rows = [*grade_all(course, find_submissions(course))]
    assert [row.student_id for row in rows if row.again] == ['eve']
    assert [row.is_undecided for row in rows] == [True] * MOST_IN_VAIN + [True, False]


def test_the_first_result_stays_if_the_second_grading_fails(course):
    submit(course, 'ada', answered(course, f'{RIGHT}  # busy 1'))
    submit(course, 'eve', answered(course, f'{RIGHT}  # busy 1'))
    rows = []
    for row in grade_all(course, find_submissions(course)):
        rows.append(row)
        if len(rows) == 2:  # both are graded once
            shutil.rmtree(course.folder('submitted', 'ada', TOY))
            deep = Path(*['deep'] * (MAX_DEPTH + 1))
            (course.folder('submitted', 'eve', TOY) / deep).mkdir(parents=True)
    first, again = rows[:2], rows[2:]
    assert [row.student_id for row in again] == ['ada', 'eve']
    assert [row.stored for row in again] == [row.stored for row in first]
    assert again[0].reason.endswith(f'; then not graded, {GONE}')
    assert 'folders in each other' in again[1].reason
    assert is_undecided(graded_notebook(course, 'ada', TOY))


def test_a_check_whose_points_a_person_gave_is_not_tried_again(course):
    submit(course, 'ada', answered(course, f'{RIGHT}  # busy 9', explained='so'))
    list(grade_all(course, find_submissions(course)))
    give_points(course, 'ada')
    assert [row.again for row in grade_all(course, find_submissions(course))] == [False]


def test_a_score_given_by_hand_replaces_the_reason_why_there_was_none(course):
    submit(course, 'ada', answered(course, f'{RIGHT}  # busy 9', explained='so'))
    list(grade_all(course, find_submissions(course)))
    page = course.folder('feedback', 'ada', TOY) / f'{TOY}.html'
    for decided in False, True:
        if decided:
            give_points(course, 'ada')
        assert main(['scores'], course=course) == 0
        assert main(['feedback'], course=course) == 0
        told = (course.gradebook / 'scores.csv').read_text(), page.read_text()
        assert [UNDECIDED in text for text in told] == [not decided] * 2


@pytest.mark.parametrize('students', [['ada'], ['ada', 'bob']])
def test_a_check_that_could_not_decide_is_tried_again_by_the_next_run(course, capsys, students):
    for student in students:
        submit(course, student, answered(course, f'{RIGHT}  # busy 2', explained='so'))
    submit(course, 'eve', answered(course, RIGHT))
    which = 'it' if len(students) == 1 else 'them'
    assert main(['grade'], course=course) == 0
    why = 'because a check could not decide'
    wanted = f'{len(students)} of these {why}: ./course grade grades {which} again'
    assert wanted in capsys.readouterr().out
    assert main(['grade'], course=course) == 0
    said = capsys.readouterr().out
    assert f'{len(students)} graded, 1 unchanged' in said
    assert 'could not decide' not in said


def test_an_empty_gradebook_is_reported_with_the_place_of_submissions(tmp_path, released):
    empty = Course(root=released.root, gradebook=tmp_path / 'none')
    with pytest.raises(CourseError, match='STUDENT/ASSIGNMENT'):
        find_submissions(empty)


def test_each_student_has_a_seed_and_keeps_it(course):
    def seeds():
        list(grade_all(course, find_submissions(course)))
        return {
            student: graded_notebook(course, student, TOY).metadata[KEY]['seed']
            for student in ('ada', 'bob')
        }

    submit(course, 'ada', answered(course, RIGHT))
    submit(course, 'bob', answered(course, RIGHT))
    first = seeds()
    assert first == {student: course.seed(TOY, student) for student in first}
    assert len({*first.values()}) == 2
    submit(course, 'ada', answered(course, WRONG))
    submit(course, 'bob', answered(course, WRONG))
    assert seeds() == first


def test_a_seed_can_be_given(course):
    submit(course, 'ada', answered(course, RIGHT))
    rows = list(grade_all(course, find_submissions(course), seed='abc'))
    assert rows[0].stored.score == 3.0


def test_the_table_shows_scores_reasons_and_no_escape_sequence(course, capsys):
    submit(course, 'a\x1b[31m', answered(course, WRONG))
    submit(course, '小明', answered(course, RIGHT, explained='so'))
    submissions = find_submissions(course)
    list(print_rows(grade_all(course, submissions), submissions))
    submit(course, 'a\x1b[31m', answered(course, RIGHT))
    list(print_rows(grade_all(course, submissions), submissions))
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == [
        'student    assignment  score      reason',
        'a\\x1b[31m  00_toy      0/5        expected 2, saw 3: add it to itself',
        '小明       00_toy      3/5 …      the rest is graded by hand',
    ]
    assert lines[4:] == [
        'a\\x1b[31m  00_toy      3/5        (was 0) there is no answer',
        '小明       00_toy      3/5 …      (unchanged) the rest is graded by hand',
    ]


@pytest.mark.slow
def test_a_demo_compares_outcomes_with_those_in_the_names_of_the_samples(
    course, tmp_path, capsys, monkeypatch
):
    monkeypatch.setattr(tempfile, 'tempdir', str(tmp_path))
    samples = tmp_path / 'samples'
    samples.mkdir()
    for name, answer in (('pass-right', RIGHT), ('fail-wrong', WRONG), ('zero-wrong', WRONG)):
        source = submit(course, 'x', answered(course, answer, explained='so'))
        source.rename(samples / f'{TOY}-{name}.ipynb')
    (samples / f'{TOY}-fail-no_json.ipynb').write_text('')
    assert demo(samples, root=course.root)
    assert '4 of 4 came out as named.\nA page of feedback: /' in capsys.readouterr().out
    (samples / f'{TOY}-fail-wrong.ipynb').rename(samples / f'{TOY}-pass-wrong.ipynb')
    assert not demo(samples, root=course.root)
    assert f'NOT AS NAMED: {TOY}-pass-wrong: expected 2, saw 3' in capsys.readouterr().out
    (samples / f'{TOY}-perhaps-wrong.ipynb').write_text('')
    with pytest.raises(CourseError, match='is not named'):
        demo(samples, root=course.root)


def test_no_result_is_stored_if_the_submission_changed_during_grading(course, monkeypatch):
    """Otherwise it would be the score of files that are no longer there."""
    path = submit(course, 'ada', answered(course, RIGHT))
    looked = task.execute_exercises

    async def replaced(notebook, **options):
        submit(course, 'ada', answered(course, WRONG))
        return await looked(notebook, **options)

    monkeypatch.setattr(task, 'execute_exercises', replaced)
    row = rows_of(course)['ada']
    assert 'x + 1' in path.read_text()
    assert row.stored is None
    assert row.reason == f'not graded, {CHANGED}'
    monkeypatch.setattr(task, 'execute_exercises', looked)
    assert rows_of(course)['ada'].stored.score == 0.0
