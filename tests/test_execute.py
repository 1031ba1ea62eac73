"""Executing a notebook: each exercise alone, a verdict in each grade cell, and no test told."""

import asyncio
import os
import signal
import threading
import time
from copy import deepcopy

import nbformat
import pytest
from my_robot_basics.session import pressure
from my_robot_basics.validate import budget, second_look
from my_robot_basics.validate.outputs import CellRun
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from nbgrader.utils import determine_grade

from grader.common.errors import RoomFailure
from grader.judging import execute as module
from grader.judging.execute import execute
from grader.kernels import rooms as rooms_module
from grader.notebook.restore import KEY, grade_id, make_template, restore
from grader.sandbox.limits import MAX_RESULT_PARTS

CANARY = 'hidden canary'
CHECK = f"""
from my_robot_basics.checks import expect, student
expect(student.call('double', 2) == 4, expected=4, seen='less', hint='twice')
print('note: all is well')
secret = '{CANARY}'
"""


def marked(name, source, *, new=new_code_cell, **marks):
    defaults = {'grade': False, 'solution': False, 'locked': True, 'schema_version': 3}
    return new(source, id=name, metadata={'nbgrader': defaults | marks | {'grade_id': name}})


def lesson(*exercises, check=CHECK, setup='from my_robot_basics.live import reset'):
    """Return the instructor's notebook; the exercise `a` asks for `double_a`, and so on."""
    cells = [new_code_cell(setup, id='setup')]
    for name in exercises:
        cells += [
            marked(f'{name}-reset', f"reset('double_{name}')"),
            marked(name, '# here', solution=True, locked=False),
            new_code_cell('# try it', id=f'{name}-try'),
            marked(
                f'{name}-check', check.replace('double', f'double_{name}'), grade=True, points=2
            ),
        ]
    cells.append(marked('why', '', new=new_markdown_cell, solution=True, grade=True, points=3))
    return new_notebook(cells=cells)


def handed_in(source, *, after=(), before=(), **answers):
    """Return the restored notebook of a student who answered so, with own cells around."""
    template = make_template(source, source)
    submitted = nbformat.from_dict(source)
    for cell in submitted.cells:
        if name := grade_id(cell):
            cell.source = answers.get(name, cell.source).replace('double', f'double_{name}')
    cells = [*map(new_code_cell, before), *submitted.cells, *map(new_code_cell, after)]
    return restore(new_notebook(cells=cells), template).notebook


def outcomes(execution):
    return {v.grade_id: v.outcome for v in execution.verdicts}


def cells_of(execution):
    return {grade_id(c): c for c in execution.notebook.cells if grade_id(c)}


GOOD = 'def double(x): return 2 * x'


@pytest.mark.slow
def test_each_exercise_costs_only_itself(monkeypatch):
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
def test_strange_ways_to_answer(monkeypatch, own, outcome):
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
def test_what_the_lesson_shows_is_run_for_a_name_that_it_may_bind_alone(name, is_shown):
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
    """As the student had it who wrote it there, and started the answer again."""
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


class FakeRooms:
    """Rooms without kernels: what happens in them is a list of what each check comes to."""

    checks: list
    opened = 0

    def __init__(self, **options):
        pass

    async def __aenter__(self):
        type(self).opened += 1
        if self.checks and isinstance(self.checks[0], Exception):
            raise self.checks.pop(0)
        return self

    async def __aexit__(self, *_):
        pass

    student_alive = True
    used_sec = 0.0

    def student_cpu_sec(self):
        return self.used_sec * time.monotonic()

    async def run_student_cell(self, source, *, timeout_sec):
        return CellRun(status='ok')

    async def run_check(self, source):
        if source == second_look.LEAVE_CLOCKS:
            return CellRun(status='ok')
        await asyncio.sleep(0.01)
        return self.checks.pop(0)


def ended(**state):
    error = state.pop('error', None)
    run = CellRun(**{'status': 'error' if error else 'ok'} | state)
    if error:
        run.keep('error', {'ename': error, 'evalue': CANARY, 'traceback': [CANARY, 'assert x']})
    return run


DEAD, LATE = ended(status=None, died=True), ended(timed_out=True)
FAILURES = {
    'the test kernel died twice': ([DEAD, DEAD], 'ungraded', 2),
    'the test kernel died once': ([DEAD, ended()], 'passed', 2),
    'the check did not end': ([LATE, LATE], 'ungraded', 2),
    'a defect of the check': ([ended(error='KeyError')] * 2, 'ungraded', 2),
    'rooms that did not open': ([RoomFailure('no room')] * 2, 'ungraded', 2),
    'rooms that opened at last': ([RoomFailure('no room'), ended()], 'passed', 2),
    'a failed check is no failure of ours': ([ended(error='CheckFailed')], 'failed', 1),
    'a failed assert is none either': ([ended(error='AssertionError')], 'failed', 1),
}


@pytest.mark.parametrize(('checks', 'outcome', 'opened'), FAILURES.values(), ids=FAILURES)
def test_the_graders_own_failure_is_tried_again_and_then_left_to_a_person(
    monkeypatch, checks, outcome, opened
):
    rooms = type('GradingRooms', (FakeRooms,), {'checks': list(checks)})
    monkeypatch.setattr(module, 'GradingRooms', rooms)
    execution = execute(handed_in(lesson('a'), a=GOOD))
    verdict = execution.verdicts[0]
    assert (verdict.outcome, rooms.opened) == (outcome, opened)
    cell = cells_of(execution)['a-check']
    assert cell.metadata[KEY].outcome == outcome
    if outcome == 'ungraded':
        assert verdict.score is None
        assert 'a person has to look at it' in cell.outputs[0].text
        assert CANARY not in str((cell.outputs, cell.metadata, verdict))
        assert 'assert x' not in str((cell.outputs, cell.metadata, verdict))


STARVED, DISTURBED = ended(error='Starved'), ended(error='Disturbed')
CHECK_FAILED = ended(error='CheckFailed')
DOUBTS = {
    'a busy machine, once': ([STARVED, ended()], True, 0.0, 'passed', 2),
    'a busy machine, twice': ([STARVED, STARVED], True, 0.0, 'ungraded', 2),
    'an idle machine': ([STARVED, STARVED], False, 0.0, 'failed', 2),
    'a machine that is busy in the checks alone': (
        [STARVED, STARVED], False, 0.0, 'ungraded', 2, True,
    ),
    'a failure at the second look': ([STARVED, CHECK_FAILED], True, 0.0, 'failed', 2),
    'who burns the time in the checks': ([STARVED, STARVED], False, 0.9, 'failed', 2, True),
    'one that goes on ending, on a busy machine': (
        [DISTURBED, DISTURBED], False, 0.0, 'failed', 2, True,
    ),
    'who burns the time itself': ([STARVED, STARVED], True, 0.9, 'failed', 2),
    'whom the clock kept busy': ([STARVED, ended()], True, 0.9, 'passed', 2),
    'a node that ended with its clock': ([DISTURBED, ended()], False, 0.0, 'passed', 2),
    'one that goes on ending': ([DISTURBED, DISTURBED], True, 0.0, 'failed', 2),
    'a busy machine after it': ([DISTURBED, STARVED], True, 0.0, 'ungraded', 2),
    'who ends and burns after it': ([DISTURBED, STARVED], True, 0.9, 'failed', 2),
}  # fmt: skip


@pytest.mark.parametrize('doubt', DOUBTS.values(), ids=DOUBTS)
def test_what_others_may_be_to_blame_for_is_looked_at_again_and_burning_time_gains_nothing(
    monkeypatch, doubt
):
    checks, is_machine_busy, used_sec, outcome, opened, *in_checks = doubt
    monkeypatch.setattr(pressure.Stopwatch, 'is_busy', lambda watch: bool(in_checks))

    async def answer():
        return is_machine_busy

    monkeypatch.setattr(second_look, 'is_machine_busy', answer)
    rooms = type('GradingRooms', (FakeRooms,), {'checks': deepcopy(checks), 'used_sec': used_sec})
    monkeypatch.setattr(module, 'GradingRooms', rooms)
    execution = execute(handed_in(lesson('a'), a=GOOD))
    verdict = execution.verdicts[0]
    assert (verdict.outcome, rooms.opened) == (outcome, opened)
    if outcome == 'ungraded':
        assert verdict.score is None
        assert 'a person has to look at it: the machine was too busy' in verdict.reason


def test_a_machine_is_busy_only_where_processes_wait_without_the_answer(monkeypatch):
    monkeypatch.setattr(second_look, 'BUSY_LOOK_SEC', 0.05)
    for share, crowd in [(0.0, False), (0.2, False), (0.9, True)]:
        monkeypatch.setattr(pressure, 'stalled_sec', lambda share=share: share * time.monotonic())
        monkeypatch.setattr(pressure, 'idle_sec', time.monotonic)
        assert asyncio.run(second_look.is_machine_busy()) is crowd


def test_a_failure_in_one_exercise_leaves_the_others_their_verdicts(monkeypatch):
    class DeadForOne(FakeRooms):
        checks = []

        async def run_check(self, source):
            return DEAD if 'double_a' in source else ended()

    monkeypatch.setattr(module, 'GradingRooms', DeadForOne)
    execution = execute(handed_in(lesson('a', 'b')))
    assert outcomes(execution) == {'a-check': 'ungraded', 'b-check': 'passed', 'why': 'manual'}


@pytest.mark.parametrize(('notebooks', 'most'), [(1, 2), (2, 3), (3, 4)])
def test_exercises_run_side_by_side_where_no_other_notebook_does(monkeypatch, notebooks, most):
    at_work, counts = [], []

    class Counting(FakeRooms):
        checks = []

        async def run_check(self, source):
            at_work.append(self)
            counts.append(len(at_work))
            await asyncio.sleep(0.1)
            at_work.remove(self)
            return ended()

    async def several():
        papers = [handed_in(lesson('a', 'b', 'c'), a=GOOD) for _ in range(notebooks)]
        return await asyncio.gather(*map(module.execute_exercises, papers))

    monkeypatch.setattr(module, 'GradingRooms', Counting)
    first, *_ = asyncio.run(several())
    # the first notebook has begun before the others, which take one exercise after the other
    assert max(counts) == most
    assert [each.grade_id for each in first.verdicts[:3]] == ['a-check', 'b-check', 'c-check']


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


def test_student_cells_share_one_budget(monkeypatch):
    given = []

    class Slow(FakeRooms):
        checks = [ended() for _ in range(3)]

        async def run_student_cell(self, source, *, timeout_sec):
            given.append(timeout_sec)
            await asyncio.sleep(min(timeout_sec, 0.2) if 'loop' in source else 0)
            return CellRun(status='ok')

    monkeypatch.setattr(module, 'GradingRooms', Slow)
    monkeypatch.setattr(module, 'Budget', lambda: budget.Budget(0.5))
    execute(handed_in(lesson('a', 'b', 'c'), a='loop', b='loop', c='loop'))
    assert given == sorted(given, reverse=True)
    assert max(given) <= 0.5
    assert min(given) >= 0.1  # a cell is never given no time at all


def test_it_works_inside_a_running_event_loop(monkeypatch):
    monkeypatch.setattr(module, 'GradingRooms', type('R', (FakeRooms,), {'checks': [ended()]}))

    async def formgrader():
        return execute(handed_in(lesson('a')))

    assert outcomes(asyncio.run(formgrader()))['a-check'] == 'passed'


@pytest.mark.parametrize('inside_a_loop', [False, True])
def test_ctrl_c_closes_the_rooms_and_ends(monkeypatch, inside_a_loop):
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


def test_a_notebook_keeps_so_much_output_and_says_so_of_the_rest():
    space, cell = module._OutputSpace(2_000), [new_output('stream', text='x' * 400)]
    assert space.fit(cell) == space.fit(cell) == cell
    [output] = space.fit(cell)
    assert output.text.startswith('[not kept: all cells together printed more than 4,000,000')
    assert space.fit([]) == []


def test_of_many_small_outputs_few_are_kept():
    space, cell = module._OutputSpace(), [new_output('stream', text='x')] * 1_000
    kept = sum(len(space.fit(cell)) == 1_000 for _ in range(40))
    assert kept * len(cell) <= 8_000


def test_of_outputs_in_many_parts_no_more_are_kept_than_a_result_may_have():
    space = module._OutputSpace()
    parts = new_output('display_data', {}, metadata={f'{n}': {} for n in range(10_000)})
    kept = sum(space.fit([parts]) == [parts] for _ in range(40))
    assert 0 < kept * 10_000 < MAX_RESULT_PARTS / 2
