"""An answer that a person grades: it waits, gets its points in the formgrader, and keeps them."""

import csv
import json
import os
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from pathlib import Path

import nbformat
import pytest
from course_maker import TOY, answered, executed, released_course, submit
from looked_at import score_by_hand

from grader.export.scores import write_scores
from grader.grading import SubmissionOutcome
from grader.notebook.restore import restore
from grader.notebook.submission import read_submission
from grader.report.feedback import write_feedback
from grader.report.progress_table import reason_in_a_line, score_of
from grader.storage.database import open_database
from grader.storage.gradebook import recover, store
from grader.storage.pipeline import sanitize_restored
from grader.storage.records import graded_notebook

TOKEN = 'a-token'
RIGHT = 'def double(x):\n    return 2 * x'
BECAUSE = 'Because **two** of it are twice of it.'


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    course = released_course(tmp_path_factory.mktemp('course'))
    grade(course, 'ada', BECAUSE)
    grade(course, 'bob', '')
    return course


@pytest.fixture(scope='module')
def formgrader(course, tmp_path_factory):
    """Calls the formgrader of a running Jupyter server, as an instructor's browser does."""
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        port = free.getsockname()[1]
    folder = tmp_path_factory.mktemp('jupyter')
    mine = {f'JUPYTER_{name}_DIR': str(folder / name) for name in ('CONFIG', 'DATA', 'RUNTIME')}
    programs = os.pathsep.join([str(Path(sys.executable).parent), os.environ['PATH']])
    with (folder / 'log').open('w') as log:
        server = subprocess.Popen(
            [
                *(sys.executable, '-m', 'jupyter_server', '--no-browser', '--allow-root'),
                *(f'--port={port}', '--ServerApp.port_retries=0'),
                f'--IdentityProvider.token={TOKEN}',
                "--ServerApp.jpserver_extensions={'nbgrader.server_extensions.formgrader': True}",
            ],
            cwd=course.root,
            env=os.environ | mine | {'PATH': programs},
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )

    def call(path, **sent):
        request = urllib.request.Request(
            f'http://127.0.0.1:{port}/formgrader/{path}',
            data=json.dumps(sent).encode() if sent else None,
            headers={'Authorization': f'token {TOKEN}'},
            method='PUT' if sent else 'GET',
        )
        with urllib.request.urlopen(request) as reply:
            text = reply.read().decode()
        return json.loads(text) if path.startswith('api/') else text

    try:
        deadline = time.monotonic() + 60
        while True:
            try:
                call('api/status')
                break
            except urllib.error.URLError:
                assert server.poll() is None, (folder / 'log').read_text()
                assert time.monotonic() < deadline, (folder / 'log').read_text()
                time.sleep(0.2)
        yield call
    finally:
        server.terminate()
        server.wait(30)


def grade(course, student, explained):
    """Submit a notebook and store it as graded, with the rooms' verdicts made up."""
    submit(course, student, answered(course, RIGHT, explained=explained))
    folder = course.folder('submitted', student, TOY)
    submission = read_submission(folder, student_id=student, assignment=TOY)
    restored = restore(submission.notebook, course.template(TOY)).notebook
    stored = store(course, submission, executed(sanitize_restored(course, TOY, restored), {}))
    return SubmissionOutcome(student, TOY, stored, stored.reason)


def exported(course, student):
    """Score and comment of the text in the exported table."""
    with write_scores(course).open(encoding='utf-8-sig', newline='') as file:
        [row] = [
            row
            for row in csv.DictReader(file)
            if (row['student_id'], row['grade_id']) == (student, 'explain')
        ]
    return row['score'], row['comment']


def page(course, student):
    write_feedback(course)
    return (course.folder('feedback', student, TOY) / f'{TOY}.html').read_text(encoding='utf-8')


def test_a_written_answer_waits_for_points_in_row_table_and_page(course):
    row = grade(course, 'ada', BECAUSE)
    assert (score_of(row), reason_in_a_line(row)) == ('3/5 …', 'the rest is graded by hand')
    assert exported(course, 'ada') == ('', 'to be graded by hand')
    assert '… waiting' in page(course, 'ada')
    assert 'Your instructor will read this.' in page(course, 'ada')


def test_an_empty_answer_receives_zero_points_without_manual_grading(course):
    row = grade(course, 'bob', '')
    assert (score_of(row), reason_in_a_line(row)) == ('3/5', 'there is no answer')
    assert exported(course, 'bob') == ('0.0', 'there is no answer')
    assert 'There is no answer' in page(course, 'bob')


def test_the_reason_of_a_check_replaces_the_note_on_manual_grading(course):
    row = grade(course, 'ada', BECAUSE)
    assert (
        reason_in_a_line(SubmissionOutcome('ada', TOY, row.stored, 'expected 42')) == 'expected 42'
    )


@pytest.mark.slow
def test_points_given_in_the_formgrader_are_kept_by_a_regrade(course, formgrader):
    grade(course, 'ada', BECAUSE)
    [ada] = [
        found
        for found in formgrader(f'api/submitted_notebooks/{TOY}/{TOY}')
        if found['student'] == 'ada'
    ]
    assert ada['needs_manual_grade']
    assert '<strong>two</strong>' in formgrader(f'submissions/{ada["id"]}/?index=0')

    by_name = {
        kind: {each['name']: each for each in formgrader(f'api/{kind}?submission_id={ada["id"]}')}
        for kind in ('grades', 'comments')
    }
    given = formgrader(f'api/grade/{by_name["grades"]["explain"]["id"]}', manual_score=1.5)
    assert (given['manual_score'], given['needs_manual_grade']) == (1.5, False)
    formgrader(
        f'api/comment/{by_name["comments"]["explain"]["id"]}', manual_comment='Twice of what?'
    )
    assert exported(course, 'ada') == ('1.5', 'scored by hand; Twice of what?')

    again = grade(course, 'ada', BECAUSE)
    assert (score_of(again), reason_in_a_line(again)) == ('4.5/5', '')
    assert exported(course, 'ada') == ('1.5', 'scored by hand; Twice of what?')
    html = page(course, 'ada')
    assert '✎ scored by hand' in html
    assert '1.5 of 2' in html
    assert 'Twice of what?' in html


def is_listed(course, student):
    """Whether the formgrader lists the written answer among those to grade."""
    with open_database(course.db_url) as book:
        return book.find_grade('explain', TOY, TOY, student).needs_manual_grade


def test_points_for_an_empty_answer_keep_the_reason_why_it_had_none(course):
    grade(course, 'ivan', '')
    score_by_hand(course, 'ivan', 0.5)
    assert exported(course, 'ivan') == ('0.5', 'scored by hand; there is no answer')


@pytest.mark.parametrize('again', [BECAUSE, f'\n{BECAUSE}  \n'], ids=['same', 'more space'])
def test_points_given_by_hand_stay_for_an_unchanged_answer(course, again):
    grade(course, 'cleo', BECAUSE)
    score_by_hand(course, 'cleo', 1.5)
    assert score_of(grade(course, 'cleo', again)) == '4.5/5'
    assert exported(course, 'cleo') == ('1.5', 'scored by hand')


def test_a_rewritten_answer_waits_for_points_again(course):
    """It had the points of its earlier text, and nothing said that nobody had read it."""
    grade(course, 'dora', BECAUSE)
    score_by_hand(course, 'dora', 1.5)
    row = grade(course, 'dora', 'I do not know.')
    assert (score_of(row), row.stored.former) == ('3/5 …', 4.5)
    assert exported(course, 'dora') == (
        '',
        'to be graded by hand; this answer was changed after 1.5 points had been given for it by '
        'hand: a person reads it again',
    )
    assert 'changed after 1.5 points' in page(course, 'dora')
    assert is_listed(course, 'dora')
    score_by_hand(course, 'dora', 0.5)
    assert exported(course, 'dora') == ('0.5', 'scored by hand')
    assert 'changed after' not in page(course, 'dora')


@pytest.mark.parametrize('third', ['I do not know.', 'Nobody knows.'])
def test_a_note_of_earlier_points_stays_until_somebody_has_read_the_answer(course, third):
    """The database has forgotten these points after the second hand-in."""
    student = f'jan{len(third)}'
    grade(course, student, BECAUSE)
    score_by_hand(course, student, 1.5)
    grade(course, student, 'I do not know.')
    grade(course, student, third)
    assert 'after 1.5 points' in exported(course, student)[1]
    score_by_hand(course, student, 1.0)
    grade(course, student, third)
    assert exported(course, student) == ('1.0', 'scored by hand')


def test_a_result_that_is_stored_again_keeps_the_points_of_a_rewritten_answer(course):
    grade(course, 'emil', BECAUSE)
    score_by_hand(course, 'emil', 1.5)
    grade(course, 'emil', 'I do not know.')
    score_by_hand(course, 'emil', 0.5)
    folder = course.folder('submitted', 'emil', TOY)
    submission = read_submission(folder, student_id='emil', assignment=TOY)
    store(course, submission, graded_notebook(course, 'emil', TOY))  # as a kept result
    assert exported(course, 'emil') == ('0.5', 'scored by hand')


def test_a_removed_answer_loses_the_points_that_it_was_given(course):
    grade(course, 'finn', BECAUSE)
    score_by_hand(course, 'finn', 1.5)
    row = grade(course, 'finn', '')
    assert (score_of(row), reason_in_a_line(row)) == ('3/5', '(was 4.5) there is no answer')
    assert exported(course, 'finn') == ('0.0', 'there is no answer')
    assert not is_listed(course, 'finn')


def test_points_stay_if_nothing_shows_what_the_answer_was(course):
    grade(course, 'gina', BECAUSE)
    score_by_hand(course, 'gina', 1.5)
    (course.folder('autograded', 'gina', TOY) / f'{TOY}.ipynb').write_text('damaged')
    assert score_of(grade(course, 'gina', 'Another text.')) == '4.5/5'


def test_a_killed_run_forgets_no_points_of_a_rewritten_answer(course, monkeypatch):
    """`recover` stores it once more, when the database knows nothing of the earlier points."""
    grade(course, 'hugo', BECAUSE)
    score_by_hand(course, 'hugo', 1.5)

    def fail(*_):
        raise OSError('the disk is full')

    with monkeypatch.context() as killed:
        killed.setattr(nbformat.v4, 'writes', fail)
        with pytest.raises(OSError, match='the disk is full'):
            grade(course, 'hugo', 'I do not know.')
    recover(course)
    score, comment = exported(course, 'hugo')
    assert not score
    assert 'after 1.5 points' in comment
