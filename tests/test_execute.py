"""Running a notebook: each exercise by itself, a verdict in each grade cell, no test revealed."""

import asyncio
import os
import signal
import threading
import time

import nbformat
import pytest
from doubling_lesson import CANARY, GOOD, cells_of, handed_in, lesson, marked, outcomes
from fake_rooms import FakeRooms, ended
from my_robot_basics.validate.verdicts import budget
from nbformat.v4 import new_code_cell
from nbgrader.utils import determine_grade

from grader.judging import execute as module
from grader.judging.execute import execute
from grader.kernels import rooms as rooms_module
from grader.notebook.restore import KEY


@pytest.mark.slow
def test_a_failing_exercise_does_not_affect_other_exercises(monkeypatch):
    monkeypatch.setattr(budget, 'STUDENT_CELL_TIMEOUT_SEC', 4.0)
    answers = {
        'good': GOOD,
        'raises': '1 / 0',
        'wrong': 'def double(x): return x',
        'loops': 'while True: pass',
        'quits': 'import os; os._exit(0)',
        'last': GOOD,
    }
    notebook = handed_in(lesson(*answers), **answers)
    before = nbformat.writes(notebook)
    execution = execute(notebook)
    assert nbformat.writes(notebook) == before
    assert outcomes(execution) == {
        'good-check': 'passed',
        'raises-check': 'failed',
        'wrong-check': 'failed',
        'loops-check': 'failed',
        'quits-check': 'failed',
        'last-check': 'passed',
        'why': 'manual',
    }
    reasons = {v.grade_id: (v.reason, v.notes) for v in execution.verdicts}
    assert reasons['good-check'] == ('', ('all is well',))
    assert reasons['wrong-check'] == ('expected 4, saw less: twice', ())
    assert reasons['loops-check'][1] == ('your cell `loops` did not end and was interrupted',)
    assert reasons['raises-check'][1] == (
        'your cell `raises` stopped with ZeroDivisionError: division by zero',
    )
    assert 'your cell `quits` ended the kernel' in reasons['quits-check'][0]
    cells = cells_of(execution)
    for verdict in execution.verdicts:
        if verdict.outcome != 'manual':
            assert determine_grade(cells[verdict.grade_id]) == (verdict.score, 2.0)
    for cell in cells.values():
        assert CANARY not in str((cell.get('outputs'), cell.metadata))
    nbformat.validate(execution.notebook)


GOOD_A = GOOD.replace('double', 'double_a')
STRANGE = {
    'a helper in a cell of its own': (
        {'a': 'def double(x): return helper(x)', 'before': ['def helper(x): return 2 * x']},
        'passed',
    ),
    'the answer in a cell after the checks': ({'a': '', 'after': [GOOD_A]}, 'passed'),
    'a helper that the text does not show': (
        {'a': 'double = eval("hel" + "per")', 'before': ['def helper(x): return 2 * x']},
        'passed',
    ),
    'a helper that is looked up when it is called': (
        {
            'a': 'def double(x): return globals()["helper"](x)',
            'before': ['def helper(x): return 2 * x'],
        },
        'passed',
    ),
    'a helper of a module beside the notebook, so to speak': (
        {
            'a': 'import types\nm = types.ModuleType("m")\n'
            'exec("import __main__\\ndef twice(x): return __main__.helper(x)", vars(m))\n'
            'double = m.twice',
            'before': ['def helper(x): return 2 * x'],
        },
        'passed',
    ),
    'a cell of no use that loops': ({'a': GOOD, 'before': ['while True: pass']}, 'passed'),
    'cells of no use that fail': (
        {'a': GOOD, 'before': ['1 / 0'], 'after': ['import os; os._exit(0)']},
        'passed',
    ),
    'stderr and warnings': (
        {'a': f'import sys, warnings\nprint("e", file=sys.stderr)\nwarnings.warn("w")\n{GOOD}'},
        'passed',
    ),
    'nothing': ({'a': ''}, 'failed'),
    'a name misspelled': ({'a': 'double = doubel'}, 'failed'),
    'an input': ({'a': 'n = input("n? ")\n' + GOOD}, 'failed'),
    'an answer of an earlier cell': (
        {'a': '', 'before': [GOOD_A + '\nimport builtins; builtins.double_a = double_a']},
        'failed',
    ),
}  # fmt: skip


@pytest.mark.parametrize(('own', 'outcome'), STRANGE.values(), ids=STRANGE)
def test_each_unusual_way_to_answer_gets_its_verdict(monkeypatch, own, outcome):
    monkeypatch.setattr(budget, 'STUDENT_CELL_TIMEOUT_SEC', 4.0)
    execution = execute(handed_in(lesson('a'), **own))
    assert outcomes(execution)['a-check'] == outcome


SHOWN = {
    'a name in a function': (['two = 2'], 'def double(x): return two * x'),
    'what that needs': (['one = 1', 'two = one + one'], 'def double(x): return two * x'),
    'more than names': (
        ['import sys', 'sys.two = 2', 'two = sys.two'], 'def double(x): return two * x',
    ),
}  # fmt: skip


@pytest.mark.parametrize(('demos', 'answer'), SHOWN.values(), ids=SHOWN)
def test_a_function_may_use_names_that_the_lesson_has_shown(demos, answer):
    source = lesson('a')
    source.cells[1:1] = [new_code_cell(demo, metadata={'tags': ['demo']}) for demo in demos]
    assert outcomes(execute(handed_in(source, a=answer)))['a-check'] == 'passed'


@pytest.mark.parametrize(
    ('name', 'is_shown'), [('prnit', False), ('shown', True), ('nothing_of_it', False)]
)
def test_a_demo_cell_is_run_only_for_an_undefined_name_that_its_code_mentions(name, is_shown):
    source = lesson('a')
    shown = new_code_cell('if 0 < 1:\n    print("shown")', metadata={'tags': ['demo']})
    source.cells.insert(1, shown)
    execution = execute(handed_in(source, a=f'{name}(1)\n{GOOD}'))
    assert outcomes(execution)['a-check'] == 'failed'
    assert f"NameError: name '{name}' is not defined" in execution.verdicts[0].notes[0]
    assert bool(execution.notebook.cells[1].outputs) == is_shown


IS_TWO = """
from my_robot_basics.checks import expect, student
expect(student.value('made') == 2, expected=2, seen='less', hint='two')
"""
AT_ONCE, LATER = 'made = double()', 'try: made = double()\nexcept NameError: made = 0'
"""What a constructor does when the answer is started, and what its first callback does."""
BELOW = {
    'a constructor that calls a helper': ('def double(): return two()', AT_ONCE),
    'a callback that does': ('def double(): return two()', LATER),
    'a decorator': ('@same\ndef double(): return two()', AT_ONCE),
    'a default argument': ('def double(n=two()): return n', AT_ONCE),
    'a base class': ('class double(Two):\n    def __new__(cls): return 2', AT_ONCE),
}


@pytest.mark.parametrize(('answer', 'start'), BELOW.values(), ids=BELOW)
def test_a_helper_may_stand_below_the_cell_that_starts_the_answer(answer, start):
    """For the student it worked: they ran the helper, and started the answer again."""
    helpers = 'def two(): return 2\ndef same(x): return x\nTwo = int'
    source = lesson('a', check=IS_TWO)
    source.cells.insert(3, marked('a-run', start.replace('double', 'double_a')))
    notebook = handed_in(source, a=answer)
    next(cell for cell in notebook.cells if cell.source == '# try it').source = helpers
    assert outcomes(execute(notebook))['a-check'] == 'passed'


def test_the_seed_reaches_the_checks_and_not_the_student():
    check = "import os; print('note: ' + os.environ['MY_ROBOT_BASICS_SEED'])"
    source = lesson('a', check=check)
    answer = 'import os; print(os.environ.get("MY_ROBOT_BASICS_SEED"))'
    execution = execute(handed_in(source, a=answer), seed='beef')
    assert execution.verdicts[0].notes == ('beef',)
    assert cells_of(execution)['a'].outputs[0].text == 'None\n'


def test_a_check_with_a_defect_is_ungraded_and_quotes_nothing():
    source = lesson('a', check=f'secret = "{CANARY}"\n{{}}[secret]')
    execution = execute(handed_in(source, a=GOOD))
    assert execution.verdicts[0].outcome == 'ungraded'
    assert 'it stopped with KeyError' in execution.verdicts[0].reason
    cell = cells_of(execution)['a-check']
    assert CANARY not in str((cell.outputs, cell.metadata, execution.verdicts))


def test_a_notebook_that_could_not_be_read_fails_without_running(monkeypatch):
    monkeypatch.setattr(module, 'GradingRooms', None)
    notebook = handed_in(lesson('a', 'b'))
    notebook.metadata[KEY] = {'notes': ['damaged'], 'problem': 'damaged'}
    execution = execute(notebook)
    assert {v.grade_id: v.reason for v in execution.verdicts} == {
        'a-check': 'damaged',
        'b-check': 'damaged',
        'why': '',
    }
    assert execution.notes == ('damaged',)
    assert determine_grade(cells_of(execution)['a-check']) == (0, 2.0)


def test_execute_works_inside_a_running_event_loop(monkeypatch):
    monkeypatch.setattr(module, 'GradingRooms', type('R', (FakeRooms,), {'checks': [ended()]}))

    async def formgrader():
        return execute(handed_in(lesson('a')))

    assert outcomes(asyncio.run(formgrader()))['a-check'] == 'passed'


@pytest.mark.parametrize('inside_a_loop', [False, True])
def test_ctrl_c_closes_the_rooms_and_ends_the_execution(monkeypatch, inside_a_loop):
    events = []

    class Endless(FakeRooms):
        checks = []

        async def run_student_cell(self, source, *, timeout_sec):
            events.append('running')
            await asyncio.sleep(600)

        async def __aexit__(self, *_):
            events.append('closed')

    def interrupt():
        while not events:
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(module, 'GradingRooms', Endless)
    threading.Thread(target=interrupt).start()

    async def formgrader():
        # an event loop of its own would take Ctrl-C for itself
        signal.signal(signal.SIGINT, signal.default_int_handler)
        return execute(handed_in(lesson('a')))

    with pytest.raises(KeyboardInterrupt):
        asyncio.run(formgrader()) if inside_a_loop else execute(handed_in(lesson('a')))
    assert events == ['running', 'closed']


def test_the_real_rooms_are_used_unless_a_test_says_otherwise():
    assert module.GradingRooms is rooms_module.GradingRooms
