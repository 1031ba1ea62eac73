"""A result is used again if nothing that it depends on has changed."""

import sqlite3

import nbformat
import pytest
from course_maker import TOY, answered, submit, toy_lesson, write_source
from looked_at import RIGHT, WRONG, graded_path, looked_at_course, rows_of, score_by_hand
from nbgrader.api import Gradebook
from sqlalchemy import event
from sqlalchemy.engine import Engine
from stand_in import Here

from grader.grading import Grading
from grader.notebook import submission
from grader.notebook.restore import KEY
from grader.report.progress_table import changes


@pytest.fixture
def looked():
    """The answers that were run, in their order."""
    return []


@pytest.fixture
def course(tmp_path, monkeypatch, looked):
    return looked_at_course(tmp_path, monkeypatch, looked)


def test_an_unchanged_submission_is_not_run_again_and_marked_as_reused(course, looked):
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


def test_an_unchanged_notebook_is_not_read_again(course, looked, monkeypatch):
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


def test_a_worker_starts_before_lessons_are_prepared_only_if_there_is_work(
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


def test_each_reused_result_takes_at_most_three_database_queries(course, looked):
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


def test_the_option_force_runs_an_unchanged_submission_again(course, looked):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    assert not rows_of(course, force=True)['ada'].reused
    assert len(looked) == 2


def test_changed_outputs_of_the_lesson_do_not_prevent_reuse(course, looked):
    submit(course, 'ada', answered(course, RIGHT))
    rows_of(course)
    lesson = toy_lesson()
    lesson.cells[2].outputs = []
    write_source(course, lesson)
    assert rows_of(course)['ada'].reused


def test_a_submission_is_run_again_after_a_failure_of_the_grader(course, looked):
    submit(course, 'ada', answered(course, '# no room'))
    assert rows_of(course)['ada'].stored.pending
    assert not rows_of(course)['ada'].reused
    assert len(looked) == 4  # each run tries it, and once more at its end


def test_scores_lost_or_changed_in_the_gradebook_are_stored_again_without_a_run(course, looked):
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


def test_a_manual_score_is_kept_and_not_asked_for_again(course):
    submit(course, 'ada', answered(course, RIGHT, explained='so'))
    rows_of(course)
    score_by_hand(course, 'ada', 1.5)
    row = rows_of(course)['ada']
    assert (row.reused, row.stored.score, row.stored.pending) == (True, 4.5, False)
    with sqlite3.connect(course.gradebook / 'gradebook.db') as database:
        asked = 'select count(*) from grade where needs_manual_grade'
        assert database.execute(asked).fetchone() == (0,)
    assert rows_of(course, force=True)['ada'].stored.score == 4.5


def test_a_changed_deadlines_file_changes_late_penalties_without_a_run(course, looked):
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


def test_only_scores_that_changed_are_listed(course):
    submit(course, 'ada', answered(course, RIGHT))
    submit(course, 'bob', answered(course, WRONG))
    assert changes(rows_of(course).values()) == []
    submit(course, 'bob', answered(course, RIGHT))
    assert changes(rows_of(course).values()) == ['bob  00_toy  1 → 3 (+2)']
