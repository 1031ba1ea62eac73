import io
import signal
import sys
import threading
import time
from dataclasses import replace

from course_maker import make_course, submit

from grader.__main__ import main
from grader.cli import grade_verb
from grader.grading import SubmissionOutcome
from grader.report import progress_table
from grader.report.progress_table import print_rows, reason_in_a_line
from grader.storage.gradebook import StoredResult
from grader.storage.submitted import SubmissionFolder
from grader.workers.workers import Workers

SAID = {
    'ada': StoredResult(score=5.0, max_score=5.0, former=None, pending=False, reason=''),
    'bob': StoredResult(score=2.0, max_score=5.0, former=None, pending=False, reason='?'),
    'eve': StoredResult(score=5.0, max_score=5.0, former=None, pending=True, reason='?'),
}


class Terminal(io.StringIO):
    def isatty(self):
        return True


def slowly(names):
    for name in names:
        time.sleep(0.2)  # the bar is drawn ten times a second at most
        yield SubmissionOutcome(name, '00_toy', SAID.get(name), 'no room')


def test_a_terminal_shows_the_number_done_the_rate_and_the_remaining_time(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, 'stderr', Terminal())
    names = ['ada', 'bob', 'eve', 'kim']
    submissions = [SubmissionFolder(name, '00_toy', tmp_path) for name in names]
    list(print_rows(slowly(names), submissions))
    drawn = [line for line in sys.stderr.getvalue().split('\r') if '3/4' in line]
    assert drawn
    done, _, rate = drawn[-1].partition('[')[2].partition('<')
    assert done.startswith('00:')
    assert rate.startswith('00:')  # not ?, as before the first submission
    assert 'notebook/s' in rate
    assert '1 with all points, 1 with fewer, 1 for a person' in rate


def test_the_progress_bar_is_redrawn_while_a_submission_takes_long(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, 'stderr', Terminal())
    monkeypatch.setattr(progress_table, 'TICK_SEC', 0.01)

    def one_long():
        deadline = time.monotonic() + 60
        while sys.stderr.getvalue().count('0/1') < 5:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        yield SubmissionOutcome('ada', '00_toy', None, 'no room')

    list(print_rows(one_long(), [SubmissionFolder('ada', '00_toy', tmp_path)]))
    assert not [thread for thread in threading.enumerate() if thread.name == 'bar']


def test_output_that_is_not_a_terminal_contains_only_rows(monkeypatch, tmp_path, capsys):
    list(print_rows(slowly(['zoe']), [SubmissionFolder('zoe', '00_toy', tmp_path)]))
    printed = capsys.readouterr()
    assert printed.err == ''
    assert [line.split() for line in printed.out.splitlines()] == [
        ['student', 'assignment', 'score', 'reason'],
        ['zoe', '00_toy', '–', 'no', 'room'],
    ]


def test_a_row_shows_the_late_penalty_and_whether_the_score_is_unchanged():
    late = replace(SAID['bob'], former=2.0, late=0.3)
    row = SubmissionOutcome('bob', '00_toy', late, 'count again', reused=True)
    assert reason_in_a_line(row) == '(unchanged) (late: -0.3) count again'
    assert reason_in_a_line(replace(row, stored=replace(late, former=2.3))) == (
        '(was 2.3) (late: -0.3) count again'
    )


def test_a_row_counts_as_graded_if_ctrl_c_comes_right_after_it_is_printed(
    monkeypatch, tmp_path, capsys
):
    course = make_course(tmp_path)
    for name in ('ada', 'bob', 'eve'):
        submit(course, name, b'')
    monkeypatch.setattr(Workers, 'begin', lambda _: None)  # nothing is run
    monkeypatch.setattr(
        grade_verb,
        'grade_all',
        lambda course, found, **_: (
            SubmissionOutcome(each.student_id, each.assignment, SAID[each.student_id], '')
            for each in found
        ),
    )

    def write(line):
        print(line)
        if line.startswith('bob'):
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(progress_table.tqdm, 'write', write)
    assert main(['grade'], course=course) == 128 + signal.SIGINT
    said = capsys.readouterr()
    assert [line.split()[0] for line in said.out.splitlines()] == ['student', 'ada', 'bob']
    assert 'stopped. 2 of 3 submissions are graded and stored' in said.err
