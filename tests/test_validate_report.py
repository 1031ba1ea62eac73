"""The report of Validate: its summary, its lines, and when it comes."""

import asyncio
from dataclasses import replace
from types import SimpleNamespace

import pytest
from answered import answered
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.lessons.cells import KEY
from my_robot_basics.validate.reports.as_text import as_text
from my_robot_basics.validate.reports.check_feedback import make_check
from my_robot_basics.validate.reports.report import CheckFeedback, ExerciseFeedback, Report
from my_robot_basics.validate.running import run
from my_robot_basics.validate.verdicts.verdict import Verdict
from nbformat.v4 import new_code_cell


def check(outcome, points=2.0, *, earned=None, hidden=False):
    earned = (points if outcome == 'passed' else 0.0) if earned is None else earned
    return CheckFeedback(outcome, f'It is {outcome}', points, outcome, hidden, earned, message='')


def report(*checks):
    return Report('lesson.ipynb', (ExerciseFeedback('exercise', (), checks),), ())


SUMMARIES = {
    'all is seen': ([check('passed')], 'All visible checks pass.', True),
    'a part is hidden': (
        [check('passed', 3.0), check('passed', hidden=True)],
        'All visible checks pass. 2 of 5 points are decided at grading.',
        True,
    ),
    'one point is open': (
        [check('passed'), check('passed', 1.0, hidden=True)],
        'All visible checks pass. 1 of 3 points is decided at grading.',
        True,
    ),
    'all is hidden': (
        [check('at grading')],
        'Nothing here can be checked before grading. 2 of 2 points are decided at grading.',
        True,
    ),
    'a text': (
        [check('passed'), check('by hand')],
        'All visible checks pass. A person gives 2 points for what you have written.',
        True,
    ),
    'one fails': (
        [check('passed', 3.0, hidden=True), check('failed', hidden=True)],
        '1 of 2 visible checks fails: 2 points missing. 3 of 5 points are decided at grading.',
        False,
    ),
    'a part is right': (
        [check('partial', earned=1.0, hidden=True)],
        '1 of 1 visible checks fails: 1 point missing. 1 of 2 points is decided at grading.',
        False,
    ),
    'one could not be checked': (
        [check('not checked'), check('failed')],
        '1 of 2 visible checks fails: 2 points missing. 1 of 2 could not be checked.',
        False,
    ),
}


@pytest.mark.parametrize(('checks', 'summary', 'passed'), SUMMARIES.values(), ids=SUMMARIES)
def test_a_summary_promises_no_more_than_is_known(checks, summary, passed):
    told = report(*checks)
    assert (told.summary, told.passed) == (summary, passed)
    assert as_text(told).endswith(summary)
    assert told.as_data()['summary'] == summary


def test_a_summary_in_chinese_translates_each_of_its_sentences():
    told = report(
        check('failed'), check('not checked', 1.0), check('passed', hidden=True), check('by hand')
    )
    assert replace(told, language='zh_CN').summary == (
        '3 项看得见的检查中有 1 项未通过：少了 2 分。3 项中有 1 项无法检查。'
        '7 分中有 2 分在评分时确定。你写的内容由人工评分，占 2 分。'
    )


LINES = {
    check('passed'): '  ✓ It is passed (2 points)',
    check('failed', 1.0): '  ✗ It is failed (0 of 1 point)',
    check('partial', earned=1.0, hidden=True): (
        '  ✗ It is partial (1 of 2 points; more checks at grading)'
    ),
    check('by hand'): '  … It is by hand (2 points; a person reads it)',
    check('at grading'): '  … It is at grading (2 points; checked only at grading)',
    check('not checked'): '  ? It is not checked (2 points; could not be checked)',
}


@pytest.mark.parametrize(('one', 'line'), LINES.items(), ids=lambda each: str(each)[:20])
def test_the_line_of_a_check_shows_its_mark_and_its_points(one, line):
    assert line in as_text(report(one)).splitlines()


def test_a_failure_of_validate_itself_leaves_answers_not_checked(monkeypatch, tmp_path):
    class NoRooms:
        def __init__(self, **options):
            pass

        async def __aenter__(self):
            raise RoomFailure('all ROS domains are taken')

        async def __aexit__(self, *_):
            pass

    monkeypatch.setattr(run, 'LocalRooms', NoRooms)
    told = asyncio.run(run.validate(answered('07_common_errors', tmp_path), None))
    assert [check.outcome for check in told.checks] == ['not checked'] * 3
    assert told.checks[0].message == (
        'Validate itself failed here, and your answer was not checked: all ROS domains are taken'
    )
    assert not told.passed


def test_the_report_comes_before_the_kernels_have_ended(monkeypatch, tmp_path):
    happened = []

    class Rooms:
        student_alive = True
        end_later = None

        def __init__(self, **options):
            pass

        async def __aenter__(self):
            return self

        async def __aexit__(self, failed, *_):
            assert failed is None
            self.end_later(self.end())

        async def end(self):
            await asyncio.sleep(0.1)
            happened.append('ended')

        async def run_student_cell(self, source, **options):
            return CellRun(status='ok')

        run_check = run_student_cell

        def student_cpu_sec(self):
            return None

    monkeypatch.setattr(run, 'LocalRooms', Rooms)
    path = answered('02_joint_state', tmp_path)
    asyncio.run(run.validate(path, None, tell=lambda told: happened.append('told')))
    assert happened == ['told', 'ended']


def test_the_author_of_a_hidden_part_reads_all_of_its_failure():
    cell = new_code_cell('"""It closes"""', metadata={KEY: {'role': 'grade'}})
    cell.metadata.nbgrader = {'grade_id': 'closes', 'points': 2}
    lesson = SimpleNamespace(hidden={}, altered=())
    short = 'in the part checked at grading: look at response.message'
    full = "expected 'open', saw 'closed': look at response.message"
    verdict = Verdict('closes', 'failed', 2.0, short, details=full, failed_at_grading=True)
    told = make_check(lesson, cell, verdict, [])
    assert told.message == f'in the part checked at grading: {full}'
    assert make_check(lesson, cell, replace(verdict, details=''), []).message == short


@pytest.mark.parametrize(
    ('about', 'outcome', 'expected'),
    [
        ({}, 'passed', 'passed'),
        ({}, 'manual', 'not checked'),
        ({}, 'ungraded', 'not checked'),
        ({'altered': ('closes',)}, 'passed', 'not checked'),
        ({'hidden': {'closes': 'all'}}, 'passed', 'at grading'),
        ({'hidden': {'closes': 'part'}}, 'passed', 'passed'),
        ({'altered': ('closes',), 'hidden': {'closes': 'all'}}, 'passed', 'not checked'),
    ],
)
def test_a_check_that_was_altered_or_is_hidden_shows_no_verdict(about, outcome, expected):
    cell = new_code_cell('"""It closes"""', metadata={KEY: {'role': 'grade'}})
    cell.metadata.nbgrader = {'grade_id': 'closes', 'points': 2}
    lesson = SimpleNamespace(**({'hidden': {}, 'altered': ()} | about))
    told = make_check(lesson, cell, Verdict('closes', outcome, 2.0, ''), [])
    assert told.outcome == expected
    assert make_check(lesson, cell, None, []).outcome in (expected, 'not checked')
