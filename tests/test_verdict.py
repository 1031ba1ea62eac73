"""Judging a grade cell by how it ran, and writing the verdict as nbgrader reads it."""

import nbformat
import pytest
from my_robot_basics.validate.kernels.limits import REPLIES_SEC
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.verdicts.verdict import (
    Verdict,
    is_broken,
    judge,
    leave_ungraded,
    write_verdict,
)
from nbformat.v4 import new_code_cell, new_output
from nbgrader.utils import determine_grade

from grader.common.errors import RoomFailure
from grader.notebook.restore import KEY

SECRET = 'assert hidden == 42'


@pytest.fixture
def cell():
    marks = {'grade': True, 'solution': False, 'grade_id': 'five_hz_rate', 'points': 3}
    return new_code_cell(SECRET, metadata={'nbgrader': marks, KEY: {'role': 'grade'}})


def ended(*outputs, **state):
    run = CellRun(**{'status': 'ok'} | state)
    run.outputs = [nbformat.from_dict(o) for o in outputs]
    return run


def failing(name='CheckFailed', value='expected 5.0 Hz, saw 1.0 Hz: …', **state):
    error = new_output('error', ename=name, evalue=value, traceback=['in test:', SECRET])
    return ended(error, status='error', error=error, **state)


def text(text, name='stdout'):
    return new_output('stream', name=name, text=text)


PICTURE = new_output('display_data', {'image/png': 'AA'})
RESULT = new_output('execute_result', {'text/plain': '[1]'})

SILENT = 'the check failed and gave no reason'
JUDGED = {
    'ran to its end': (ended(), 'passed', ''),
    'printed': (ended(text('fine'), PICTURE), 'passed', ''),
    'wrote on stderr': (ended(text('careful', 'stderr')), 'passed', ''),
    'ends with a value': (ended(RESULT), 'passed', ''),
    'a failed check': (failing(), 'failed', 'expected 5.0 Hz, saw 1.0 Hz: …'),
    'a failed assert': (failing('AssertionError', 'no'), 'failed', 'no'),
    'a silent assert': (failing('AssertionError', ' '), 'failed', SILENT),
}


@pytest.mark.parametrize(('run', 'outcome', 'reason'), JUDGED.values(), ids=JUDGED)
def test_a_check_that_ran_to_its_end_passes_or_fails_with_a_reason(cell, run, outcome, reason):
    verdict = judge(cell, run, [])
    assert (verdict.outcome, verdict.reason) == (outcome, reason)
    assert (verdict.grade_id, verdict.points) == ('five_hz_rate', 3.0)
    assert verdict.score == {'passed': 3.0, 'failed': 0.0}[outcome]


def points(earned):
    return new_output('display_data', {'application/vnd.my_robot_basics.points': earned})


def test_a_partly_right_answer_gets_the_points_that_its_check_reports(cell):
    run = failing('PartlyRight', '1 wrong')
    run.outputs.insert(0, points('1.0'))
    verdict = judge(cell, run, [])
    assert (verdict.outcome, verdict.score, verdict.reason) == ('partial', 1.0, '1 wrong')
    write_verdict(cell, verdict, run.outputs)
    assert determine_grade(cell) == (1.0, 3.0)
    assert cell.metadata[KEY].earned == 1.0
    assert [output.output_type for output in cell.outputs] == ['stream', 'execute_result']
    nbformat.validate(nbformat.v4.new_notebook(cells=[cell]))


def said(what):
    return new_output('display_data', {'application/vnd.my_robot_basics.hidden': what})


@pytest.mark.parametrize(
    ('outputs', 'only_there'),
    [([], False), ([said('began')], True), ([said('began'), said('already')], False)],
)
def test_a_failure_records_whether_it_occurred_only_in_the_hidden_part(cell, outputs, only_there):
    run = failing()
    run.outputs[:0] = map(nbformat.from_dict, outputs)
    verdict = judge(cell, run, [])
    assert (verdict.outcome, verdict.failed_at_grading) == ('failed', only_there)
    write_verdict(cell, verdict, run.outputs)
    assert cell.metadata[KEY].failed_at_grading is only_there


def test_a_verdict_has_the_hint_that_belongs_to_its_reason(cell):
    """A check may have had another failure before, and continued."""
    hints = 'see b', 'fix: that', 'fix: this'
    told = [new_output('display_data', {'application/vnd.my_robot_basics.hint': h}) for h in hints]
    run = failing(value='expected 1: 2, saw 2: 3: fix: this')
    run.outputs[:0] = map(nbformat.from_dict, told)
    verdict = judge(cell, run, [])
    assert verdict.hint == 'fix: this'
    write_verdict(cell, verdict, run.outputs)
    assert [output.output_type for output in cell.outputs] == ['error']
    assert cell.metadata[KEY].hint == 'fix: this'


@pytest.mark.parametrize(
    ('outputs', 'note', 'details'),
    [
        ([], 'what you started has ended: your code sent it SIGUSR1', ''),
        (
            [said('began')],
            'in the part checked at grading, what you started has ended',
            'your code sent it SIGUSR1',
        ),
    ],
)
def test_the_ending_of_an_answer_in_the_hidden_part_is_detailed_to_instructors_only(
    cell, outputs, note, details
):
    """A signal's number may be one of the hidden inputs."""
    run = failing(ending='your code sent it SIGUSR1')
    run.outputs[:0] = map(nbformat.from_dict, outputs)
    verdict = judge(cell, run, [])
    assert (verdict.notes, verdict.details) == ((note,), details)


def test_details_for_instructors_contain_the_failed_assertion_and_the_ending(cell):
    run = failing('AssertionError', '7 is not 5', ending='your code sent it SIGUSR1')
    run.outputs.insert(0, nbformat.from_dict(said('began')))
    assert judge(cell, run, []).details == '7 is not 5; your code sent it SIGUSR1'


@pytest.mark.parametrize('earned', ['0.0', '3.0', '-1.0', 'nan', 'inf'])
def test_an_invalid_number_of_partial_points_gives_no_verdict(cell, earned):
    run = failing('PartlyRight', '1 wrong')
    run.outputs.insert(0, points(earned))
    with pytest.raises(RoomFailure, match='came to no verdict'):
        judge(cell, run, [])


NO_VERDICT = {
    'another exception': (failing('KeyError', 'hidden_target'), 'it stopped with KeyError'),
    'a timeout': (failing('KeyboardInterrupt', '', timed_out=True), 'it did not end in time'),
    'a dead test kernel': (ended(status=None, died=True), 'the test kernel ended'),
    'killed after a timeout': (
        ended(status=None, timed_out=True, died=True), 'the test kernel could not be interrupted',
    ),
    'a crashed test kernel': (
        ended(status=None, died=True, crash='SIGABRT'), 'the test kernel crashed with SIGABRT',
    ),
    'no reply': (ended(status=None), 'it did not report its end'),
    'aborted': (ended(status='aborted'), 'it did not report its end'),
}  # fmt: skip


def test_a_check_without_end_fails_if_the_students_code_took_the_time(cell):
    run = failing('KeyboardInterrupt', '', timed_out=True, replies_sec=REPLIES_SEC)
    verdict = judge(cell, run, [])
    assert (verdict.outcome, verdict.score) == ('failed', 0.0)
    assert verdict.reason.startswith('the check has not ended, because your code took over 90 s')


BROKEN = 'the test kernel could not be interrupted', 'the test kernel crashed with SIGABRT'
"""What an answer may have done to its check."""


@pytest.mark.parametrize(('run', 'happened'), NO_VERDICT.values(), ids=NO_VERDICT)
def test_a_check_that_did_not_run_to_its_end_counts_as_a_failure_of_the_grader(
    cell, run, happened
):
    with pytest.raises(RoomFailure) as failure:
        judge(cell, run, [])
    assert f'`five_hz_rate` came to no verdict: {happened}' in str(failure.value)
    assert is_broken(str(failure.value)) is (happened in BROKEN)
    assert 'hidden' not in str(failure.value)


DEAD = ended(status=None, died=True)
ENDED_BY = {
    'the answer': ([('five_hz', DEAD)], 'your cell `five_hz` ended the kernel'),
    'a loop that ignores': (
        [('five_hz', ended(status=None, died=True, timed_out=True))],
        'your cell `five_hz` did not end and could not be interrupted',
    ),
    'nobody knows': ([('five_hz', ended())], 'something that your code left running ended it'),
}


@pytest.mark.parametrize(('own', 'reason'), ENDED_BY.values(), ids=ENDED_BY)
def test_a_kernel_ended_by_student_code_earns_zero_with_the_reason(cell, own, reason):
    verdict = judge(cell, None, own)
    assert (verdict.outcome, verdict.score) == ('failed', 0.0)
    assert verdict.reason == f'the kernel of your notebook ended before the check: {reason}'


def test_a_failure_has_notes_on_what_went_wrong_in_the_students_cells(cell):
    own = [
        ('five_hz', failing('SyntaxError', "'(' was\n never closed \x1b[31m\u202e" + 'x' * 5_000)),
        ('five_hz-run', ended(timed_out=True)),
        ('fine', ended()),
        ('prints', ended(timed_out=True, _dropped=10_000_001)),
    ]
    first, second, third = judge(cell, failing(), own).notes
    assert first.startswith("your cell `five_hz` stopped with SyntaxError: '(' was never closed")
    assert first.isprintable()
    assert len(first) < 400
    assert second == 'your cell `five_hz-run` did not end and was interrupted'
    assert third == 'your cell `prints` printed over 10,000,000 characters and was interrupted'
    assert judge(cell, ended(), own).notes == ()


SWAPPED = """\
rclpy_resolve_name(): incompatible function arguments. The following argument types are supported:
    1. (arg0: rclpy::Node, arg1: str, arg2: bool, arg3: bool) -> str

Invoked with: <rclpy.Node object at 0x7f>, <class 'sensor_msgs.msg.JointState'>, False, False"""


@pytest.mark.parametrize(
    ('error', 'told'),
    [
        (('SyntaxError', "expected ':' (63915088.py, line 15)"), "expected ':' (line 15)"),
        (
            ('IndentationError', 'unindent does not match (<tokenize>, line 5)'),
            'unindent does not match (line 5), so let all lines of a block begin with equally '
            'many spaces',
        ),
        (('SyntaxError', 'no end (<string>, line 1)'), 'SyntaxError: no end (line 1)'),
        (('SyntaxError', 'no end (<ipython-input-3-a1>, line 1)'), 'SyntaxError: no end (line 1)'),
        (('NotImplementedError', ''), 'stopped with NotImplementedError'),
        (('OSError', 'no data.py: (x.py)'), 'stopped with OSError: no data.py: (x.py)'),
        (
            ('SyntaxError', "invalid character '，' (U+FF0C) (63915088.py, line 3)"),
            "invalid character '，' (U+FF0C) (line 3), so write ',' in its place",
        ),
        (
            ('SyntaxError', "invalid character '‘' (U+2018) (63915088.py, line 3)"),
            '(line 3), so write "\'" in its place',
        ),
        (
            ('SyntaxError', "invalid character '²' (U+00B2) (63915088.py, line 3)"),
            "invalid character '²' (U+00B2) (line 3), so write '**2' in its place",
        ),
        (
            ('SyntaxError', "invalid character '€' (U+20AC) (63915088.py, line 3)"),
            "invalid character '€' (U+20AC) (line 3)",
        ),
        (
            ('SyntaxError', 'invalid non-printable character U+00A0 (63915088.py, line 3)'),
            'so type that line again: it has a space of another kind, as copied text may have',
        ),
        (
            ('TypeError', SWAPPED),
            'rclpy_resolve_name(): incompatible function arguments, so give the type first, such'
            ' as JointState, and the name of the topic or service second',
        ),
        (
            ('StdinNotImplementedError', 'raw_input was called, but this frontend does not …'),
            'calls input(), and nobody answers: write the value into the code',
        ),
    ],
)
def test_an_error_of_a_students_cell_is_shortened_and_explained(cell, error, told):
    [note] = judge(cell, failing(), [('five_hz', failing(*error))]).notes
    assert note.endswith(told)


CALLED = """\
\x1b[96mCell\x1b[39m\x1b[96m \x1b[39m\x1b[32mIn[7]\x1b[39m\x1b[32m, line 2\x1b[39m
\x1b[92m      1\x1b[39m y \x1b[38;5;204m=\x1b[39m 1
\x1b[92m----> \x1b[39m\x1b[92m2\x1b[39m {}"""
INSIDE = 'File rclpy/qos.py:136, in QoSProfile.reliability(self, value)\n--> 136     assert x'


@pytest.mark.parametrize(
    ('name', 'frames', 'told'),
    [
        ('AssertionError', [CALLED.format('double(0)')], 'AssertionError: line 2: double(0)'),
        (
            'StopIteration',
            [CALLED.format('a()'), CALLED.format('next(b)'), INSIDE],
            'StopIteration: line 2: next(b)',
        ),
        (
            'NotImplementedError',
            [CALLED.format('raise NotImplementedError')],
            'with NotImplementedError',
        ),
        ('KeyboardInterrupt', [INSIDE], 'stopped with KeyboardInterrupt'),
        (
            'AssertionError',
            [CALLED.format("q = QoSProfile(depth=1, reliability='best')"), INSIDE],
            "reliability='best'), so give each policy as one, such as "
            'ReliabilityPolicy.BEST_EFFORT, and depth as a whole number',
        ),
    ],
)
def test_an_error_without_a_message_is_reported_with_the_students_line(cell, name, frames, told):
    lines = '\n'.join(['---', f'{name}  Traceback (most recent call last)', *frames]).split('\n')
    run = ended(error=new_output('error', ename=name, evalue='', traceback=lines))
    [note] = judge(cell, failing(), [('five_hz', run)]).notes
    assert note.endswith(told)
    assert note.isprintable()


def test_remarks_of_a_check_become_notes(cell):
    run = ended(text('checked 50 messages\nnote: judged on the wall clock\n'), PICTURE)
    assert judge(cell, run, []).notes == ('judged on the wall clock',)


WRITTEN = [
    *[(Verdict('a', outcome='passed', points=3.0, reason=''), outs, 3.0) for outs in (
        [], [text('x')], [text('log', 'stderr')], [RESULT], [PICTURE],
    )],
    *[(Verdict('a', outcome='failed', points=3.0, reason='too slow'), outs, 0.0) for outs in (
        [], [text('x')], [RESULT], failing().outputs,
    )],
]  # fmt: skip


@pytest.mark.parametrize(('verdict', 'outputs', 'score'), WRITTEN)
def test_nbgrader_reads_the_same_score_off_a_written_verdict(cell, verdict, outputs, score):
    write_verdict(cell, verdict, outputs)
    assert determine_grade(cell) == (score, 3.0)
    assert cell.metadata[KEY].outcome == verdict.outcome
    assert SECRET not in str((cell.outputs, cell.metadata))
    assert not [o for o in cell.outputs if o.get('name') == 'stderr']
    nbformat.validate(nbformat.v4.new_notebook(cells=[cell]))


def test_a_failure_is_written_as_one_error_without_the_test(cell):
    verdict = Verdict('a', outcome='failed', points=3.0, reason='too slow', notes=('n',))
    write_verdict(cell, verdict, [text('saw 10\n'), PICTURE, *failing().outputs])
    assert [o.output_type for o in cell.outputs] == ['stream', 'display_data', 'error']
    error = cell.outputs[-1]
    assert (error.ename, error.evalue, error.traceback) == (
        'CheckFailed',
        'too slow',
        ['too slow'],
    )
    assert cell.metadata[KEY] == {
        'role': 'grade',
        'outcome': 'failed',
        'reason': 'too slow',
        'notes': ['n'],
        'details': '',
        'failed_at_grading': False,
        'earned': 0.0,
        'hint': '',
    }


def test_the_output_of_an_ungraded_cell_says_that_a_person_has_to_look(cell):
    verdict = leave_ungraded(cell, 'the test kernel did not start')
    assert (verdict.outcome, verdict.score, verdict.points) == ('ungraded', None, 3.0)
    write_verdict(cell, verdict, [])
    assert cell.outputs[0].text == (
        'not graded, a person has to look at it: the test kernel did not start\n'
    )


def test_a_manual_cell_has_no_score_yet():
    assert Verdict('why', outcome='manual', points=2.0, reason='').score is None
