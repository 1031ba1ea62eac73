"""Partial points of a check: the same in the gradebook, page, tables, report and replay."""

import csv
import json

import pytest
from course_maker import answered, executed, released_course, submit
from my_robot_basics.validate.lessons.cells import KEY, grade_id
from my_robot_basics.validate.verdicts.verdict import Verdict, write_verdict
from stand_in import stand_in

from grader.__main__ import main
from grader.grade import grade_all
from grader.judging.execute import Execution
from grader.storage.submitted import find_submissions

REASON = 'expected 4 right, saw 1 wrong, which leaves 0.5 of 2 points: `one` arrives (it is there)'


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    """A course whose one student earns half a point of two in the last check."""
    with pytest.MonkeyPatch.context() as patch:
        course = released_course(tmp_path_factory.mktemp('partial'))
        stand_in(half_a_point, patch)
        submit(course, 'ada', answered(course, 'def double(x):\n    return x', explained='so'))
        assert main(['grade'], course=course) == 0
        yield course


async def half_a_point(notebook, *, extra_files=(), seed='', trust_students=False):
    notebook = executed(notebook, {})
    notebook.metadata[KEY]['seed'] = seed
    (cell,) = (cell for cell in notebook.cells if grade_id(cell) == 'double-hidden')
    write_verdict(cell, Verdict('double-hidden', 'partial', 2.0, REASON, earned=0.5), [])
    return Execution(notebook=notebook, verdicts=(), notes=())


def test_a_partial_score_is_stored_and_reused(course):
    (row,) = grade_all(course, find_submissions(course))
    assert row.reused
    assert (row.stored.score, row.stored.max_score, row.stored.reason) == (1.5, 5.0, REASON)


def test_the_table_of_scores_contains_a_partial_score(course):
    assert main(['scores'], course=course) == 0
    rows = {
        row['grade_id']: row
        for row in csv.DictReader((course.gradebook / 'scores.csv').open(encoding='utf-8-sig'))
    }
    assert float(rows['double-hidden']['score']) == 0.5
    assert 'saw 1 wrong' in rows['double-hidden']['comment']


def test_the_feedback_page_shows_a_partial_score_once(course):
    assert main(['feedback'], course=course) == 0
    (page,) = course.folder('feedback', '', '').rglob('*.html')
    text = page.read_text(encoding='utf-8')
    assert '◐ in part' in text
    assert '0.5 of 2 points</p>' in text
    assert '>0.5</' not in text
    assert text.count('saw 1 wrong') == 1


def test_the_report_lists_the_reason_of_a_partial_score(course):
    report = max((course.gradebook / 'runs').glob('*/report.json'))
    found = json.loads(report.read_text(encoding='utf-8'))
    assert [each['example'] for each in found['reasons']] == [REASON]


def test_a_replay_gives_the_stored_partial_score_again(course, capsys):
    assert main(['grade', '--student', 'ada', '--seed', 'recorded'], course=course) == 0
    assert 'double-hidden  partial: expected 4 right' in capsys.readouterr().out
