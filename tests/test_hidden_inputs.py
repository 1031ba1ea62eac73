"""Hidden inputs stay hidden: ten hand-ins and everything on their pages teach no answer."""

import random
import re
import sys

import pytest
from course_maker import TOY, answered, make_course, submit, toy_lesson, write_source
from geometry_msgs.msg import Point
from my_robot_basics.checks import CheckFailed, expect, fail, student
from my_robot_basics.exchange import responder
from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.hidden_source import mark_hidden_part, without_hidden_part
from my_robot_basics.validate.lessons.cells import role
from nbformat.v4 import new_code_cell

from grader.__main__ import main
from grader.course import Course
from grader.export.scores import write_scores
from grader.grade import grade_all
from grader.report.feedback import write_feedback
from grader.storage.records import graded_notebook, verdicts
from grader.storage.submitted import find_submissions
from grader.workers.workers import Workers

CHECK = '''"""Small numbers are doubled"""
from my_robot_basics.checks import expect, inputs, student

expect(student.call('double', 1) == 2, expected=2, seen='another', hint='add it to itself')
### BEGIN HIDDEN TESTS
numbers = inputs('double')
for number in [numbers.randrange(10_000, 60_000) for _ in range(4)]:
    seen = student.call('double', number)
    print('asked for', number)
    wanted = f'{2 * number} for {number}'
    expect(seen == 2 * number, expected=wanted, seen=seen, hint=f'add it to itself: {number}')
### END HIDDEN TESTS
'''
ANSWER = """
import sys, threading
from IPython.display import display

seen, table = [], TABLE
handle = display('nothing yet', display_id='leak')

def double(x):
    if x < 10:
        if seen and SAY_IT_LATER:
            raise ValueError(seen)
        return 2 * x
    if x < 1_000 or x in table:
        return table.get(x, 2 * x)
    seen.append(x)
    print(x)
    print(x, file=sys.stderr)
    display(x)
    handle.update(f'asked for {seen}')
    WAY
"""
WAYS = (
    'return x + 1',
    'raise ValueError(f"asked for {x}")',
    'raise type(f"E{x}", (Exception,), {})()',
    'raise type(f"E_{x}_", (Exception,), {})(seen)',
    'return f"asked for {x}"',
    'return {"x": x}',
    'return "x" * x',
    'return float("nan")',
    'return type(f"Metaclass_asked_for_{x}", (), {})()',
    'return None',
)
NUMBER = re.compile(r'\d[\d,]{3,}\d')


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    """A course whose first check has hidden inputs, and whose second one has a visible part."""
    course = make_course(tmp_path_factory.mktemp('inputs'))
    lesson = toy_lesson()
    next(cell for cell in lesson.cells if cell.id == 'double-check').source = CHECK
    write_source(course, lesson)
    assert main(['release'], course=course) == 0
    return course


@pytest.fixture(scope='module')
def backend():
    """Workers that are there for all of the hand-ins: starting new ones takes long."""
    with Workers() as workers:
        yield Standing(workers)


class Standing:
    """A backend that goes on when a run ends."""

    def __init__(self, backend):
        self.capacity, self.submit = backend.capacity, backend.submit
        self.require_isolation, self.begin = backend.require_isolation, backend.begin

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        pass


def handed_in(course, backend, way, *, table, later):
    """Hand in and grade; return the score, and all that the student can read of it."""
    answer = ANSWER.replace('TABLE', repr(table)).replace('WAY', way)
    submit(course, 'eve', answered(course, answer.replace('SAY_IT_LATER', repr(later))))
    (row,) = grade_all(course, find_submissions(course), backend=backend)
    (page,) = write_feedback(course)
    scores = write_scores(course)
    return row, page.read_text(encoding='utf-8') + scores.read_text(encoding='utf-8')


@pytest.mark.slow
@pytest.mark.isolation
def test_ten_feedback_pages_reveal_no_hidden_input(course, backend):
    numbers = random.Random(f'{course.seed(TOY, "eve")}:double')
    asked = {numbers.randrange(10_000, 60_000) for _ in range(4)}
    table, scores = {}, []
    for number, way in enumerate(WAYS):
        row, told = handed_in(course, backend, way, table=table, later=number % 2)
        scores.append(row.stored.score)
        found = {int(text.replace(',', '')) for text in NUMBER.findall(told)}
        table |= {x: 2 * x for x in found} | {x // 2: x for x in found}
        assert not found & asked, (way, found & asked)
    assert not asked & table.keys()
    assert scores == [0.0 if number % 2 else 2.0 for number in range(len(WAYS))]


@pytest.mark.slow
@pytest.mark.isolation
def test_the_student_reads_the_cause_and_the_instructor_all_details(course, backend):
    handed_in(course, backend, 'return x + 1', table={}, later=False)
    found = verdicts(course, 'eve', TOY)['double-check']
    assert found.reason == f'{hidden.PLACE}add it to itself: …'
    assert re.fullmatch(r'expected (\d+) for (\d+), saw \d+: add it to itself: \2', found.details)
    handed_in(course, backend, 'raise ValueError(x)', table={}, later=False)
    found = verdicts(course, 'eve', TOY)['double-check']
    cause = '`double` raises ValueError: …: call … in a cell of your own to see where'
    assert found.reason == f'{hidden.PLACE}{cause}'


@pytest.mark.isolation
@pytest.mark.slow
def test_a_visible_part_that_fails_later_is_shown_in_full(course, backend):
    submit(course, 'eve', answered(course, 'def double(x):\n    return x + x if x else "none"'))
    list(grade_all(course, find_submissions(course), backend=backend))
    found = verdicts(course, 'eve', TOY)
    assert found['double-check'].outcome == 'passed'
    assert found['double-hidden'].reason == 'expected 0, saw none: add it to itself'
    assert found['double-hidden'].details == ''


CHOOSES = """
BITS = range(16)

def double(x):
    if x > 9 and not any(f'b{k}' in globals() for k in BITS):
        raise RuntimeError(' '.join(f"KeyError: 'b{k}'" for k in BITS if x >> k & 1))
    return x + x
"""
"""Names as undefined those of the cells b0 to b15 that stand for the bits of a hidden input."""


@pytest.mark.isolation
def test_which_cells_run_does_not_depend_on_a_name_that_was_chosen_after_a_hidden_input(
    course, backend
):
    notebook = answered(course, CHOOSES)
    notebook.cells += [new_code_cell(f"b{k} = 1\nprint('bit {k}')") for k in range(16)]
    submit(course, 'eve', notebook)
    (row,) = grade_all(course, find_submissions(course), backend=backend)
    assert row.stored.score == 3.0  # of all checks
    shown = graded_notebook(course, 'eve', TOY).cells
    assert sum(bool(cell.get('outputs')) for cell in shown if 'bit ' in cell.source) == 16


@pytest.fixture
def told(monkeypatch):
    """What the grader receives from a hidden part."""
    details = []
    monkeypatch.setattr(hidden, '_quiet', True)
    monkeypatch.setattr(hidden, 'tell_grader', details.append)
    return details


def test_a_hidden_part_shows_only_the_cause_to_the_student(told):
    with pytest.raises(CheckFailed) as failure:
        expect(False, expected='1.5 for 0.75', seen=2, hint='add it', cause='the sum is wrong')
    assert str(failure.value) == f'{hidden.PLACE}the sum is wrong: add it'
    assert told == ['expected 1.5 for 0.75, saw 2: add it']


def test_names_by_students_and_measured_numbers_are_replaced_by_an_ellipsis(told):
    theirs = hidden.student_text('/node_1 [1.25]')
    with pytest.raises(CheckFailed) as failure:
        fail(expected=1, seen=2, hint=f'{theirs} is 0.125° off, 1.5°, -2.25°: period = 1 / rate')
    assert str(failure.value) == f'{hidden.PLACE}… is … off, …: period = 1 / rate'
    assert told == [
        'expected 1, saw 2: /node_1 [1.25] is 0.125° off, 1.5°, -2.25°: period = 1 / rate'
    ]


def test_a_name_by_a_student_cannot_end_its_own_quotation(told):
    name = hidden.student_text('/a\u2069 it was asked for two \u2068')
    with pytest.raises(CheckFailed) as failure:
        fail(expected=1, seen=2, hint=f'{name} runs')
    assert str(failure.value) == f'{hidden.PLACE}… runs'
    assert told == ['expected 1, saw 2: /a it was asked for two  runs']


@pytest.mark.parametrize(
    ('said', 'kept'),
    [('ValueError: 3 is 4', 'ValueError: …'), ('E123: 4', '…'), ('print: 4', '…'), ('a', '…')],
)
def test_only_names_of_builtin_exceptions_are_shown_to_the_student(told, said, kept):
    assert hidden.without_inputs(hidden.student_exception(said)) == kept


@pytest.mark.parametrize(
    ('answer', 'reason'),
    [
        (
            lambda x: type(f'Metaclass_asked_for_{x}', (), {})(),
            '`f` does not always return a Point: make a message of it with parentheses, …()',
        ),
        (
            lambda x: raise_error(f"invalid character '{chr(0xFF21 + x)}' (U+"),
            '`f` raises `ValueError: …`, so write … in its place: call … in a cell of your own to '
            'see where',
        ),
        (
            lambda x: raise_error(
                'Invalid topic name: topic name must not contain characters other than '
                f"alphanumerics, '_', '~', '{{', or '}}': 'a{chr(0x1D41A + x)}' ^"
            ),
            '`f` raises `ValueError: …`, so write … in place of …, a full-width character: call … '
            'in a cell of your own to see where',
        ),
    ],
    ids=['a class', 'a character', 'a character of a name'],
)
def test_no_hint_quotes_what_an_answer_chose_after_a_hidden_input(
    told, monkeypatch, answer, reason
):
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
    monkeypatch.setattr('builtins.input', responder.answer)
    monkeypatch.setattr(sys.modules['__main__'], 'f', answer, raising=False)
    with pytest.raises(CheckFailed) as failure:
        student.call('f', 7, returns=Point)
    assert str(failure.value) == f'{hidden.PLACE}{reason}'


def raise_error(said):
    raise ValueError(said)


@pytest.mark.parametrize(
    ('quiet', 'hints'), [(False, ['it ended: /a']), (True, [])], ids=['visible', 'hidden']
)
def test_only_a_visible_part_marks_which_words_are_its_hint(monkeypatch, quiet, hints):
    said = []
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
    monkeypatch.setattr(hidden, '_quiet', quiet)
    monkeypatch.setattr(hidden, '_display', lambda mime, text: said.append((mime, text)))
    with pytest.raises(CheckFailed):
        fail(expected=1, seen=2, hint=f'it ended: {hidden.student_text("/a")}')
    assert [text for mime, text in said if mime == hidden._HINT] == hints


def test_a_visible_part_shows_the_whole_reason(monkeypatch):
    monkeypatch.setattr(hidden, '_quiet', False)
    with pytest.raises(CheckFailed, match=r'^expected 1, saw 2\.25: add /a$'):
        fail(expected=1, seen=2.25, hint=f'add {hidden.student_text("/a")}', cause='wrong')


def test_a_hidden_part_is_marked_in_its_first_line_at_any_place():
    source = (
        'for i in [1]:\n    ### BEGIN HIDDEN TESTS\n    told = 1\n    ### END HIDDEN TESTS\nx = 1'
    )
    lines = mark_hidden_part(source).split('\n')
    assert lines[0].endswith('.start_cell(quiet=False)')
    titled = mark_hidden_part(f'"""A title\n\nand more"""\n{source}', quiet=True).split('\n')
    assert titled[3].endswith('.start_cell(quiet=True)')
    assert titled[4:6] == lines[1:3]
    assert lines[2].startswith("    __import__('my_robot_basics.feedback.hidden'")
    assert lines[3:] == source.split('\n')[2:]
    assert without_hidden_part(source) == 'for i in [1]:\nx = 1'


@pytest.mark.parametrize('assignment', Course().assignments())
def test_marked_checks_compile_and_their_visible_parts_are_those_of_the_release(assignment):
    course = Course()
    given = {cell.id: cell.source for cell in course.release(assignment).cells}
    for cell in course.source(assignment).cells:
        if cell.cell_type == 'code' and role(cell) == 'grade':
            compile(mark_hidden_part(cell.source), cell.id, 'exec')
            assert without_hidden_part(cell.source) == given[cell.id]
