"""Which cells of a lesson run before one of its exercises is judged."""

import time

import nbformat
import pytest
from my_robot_basics.validate.lessons.exercises import find_exercises
from my_robot_basics.validate.lessons.misspelled import are_misspelled
from my_robot_basics.validate.lessons.plans import plan_for_names, plans
from nbformat.v4 import new_code_cell, new_notebook
from small_lesson import answer, grade, lesson, marked

from grader.notebook.restore import make_template, restore

ALONE = 'the answer alone'
LENT = 'with your other cells'
WHOLE = 'the whole lesson'
PLANS = {
    'nothing else is needed': ({}, [ALONE, LENT, WHOLE]),
    'a helper in a cell before': (
        {'area': 'def area(r): return h(r)', 'before_area': 'def h(r): return r'},
        [LENT, WHOLE],
    ),
    'a helper in the "try it" cell': (
        {'area': 'def area(r): return h(r)', 'try_it': 'def h(r): return r'},
        [LENT, WHOLE],
    ),
    'a helper after the checks': (
        {'area': 'def area(r): return h(r)', 'at_end': 'def h(r): return r'},
        [LENT, WHOLE],
    ),
    'a helper that needs one after the checks': (
        {'area': 'area = h', 'before_area': 'def h(r): return k', 'at_end': 'k = 1'},
        [LENT, WHOLE],
    ),
    'a name that a function reads, and sets': (
        {'area': 'def area(r):\n    global n\n    n += r\n    return n', 'at_start': 'n = 0'},
        [LENT, WHOLE],
    ),
    'the answer itself in another cell': (
        {'area': '', 'at_start': 'def area(r): return r'},
        [LENT, WHOLE],
    ),
    'a name that nobody binds': ({'area': 'def area(r): return tau'}, [ALONE, LENT, WHOLE]),
    'a name of a demo': ({'area': 'area = shown'}, [ALONE, LENT, WHOLE]),
    'a name of the setup': ({'area': 'area = math.sqrt'}, [ALONE, LENT, WHOLE]),
    'a helper in both': (
        {'area': 'h = 1\narea = h', 'at_start': 'h = 2'},
        [ALONE, LENT, WHOLE],
    ),
    'a name that a star import may bring': (
        {'area': 'from math import *\ndef area(r): return h', 'at_start': 'h = 2'},
        [LENT, WHOLE],
    ),
    'a star import in another cell may bring it': (
        {'area': 'def area(r): return sqrt(r)', 'at_start': 'from math import *'},
        [LENT, WHOLE],
    ),
    'a syntax error in the answer': ({'area': 'def area(:'}, [ALONE, LENT, WHOLE]),
    'a syntax error in the helper': (
        {'area': 'area = h', 'at_start': 'h = ('},
        [ALONE, LENT, WHOLE],
    ),
    'a helper beside a magic': (
        {'area': 'area = h', 'at_start': '%matplotlib inline\nh = 1'},
        [LENT, WHOLE],
    ),
    'a cell magic lends nothing': (
        {'area': 'area = h', 'at_start': '%%bash\nh=1'},
        [ALONE, LENT, WHOLE],
    ),
}


@pytest.mark.parametrize(('own', 'expected'), PLANS.values(), ids=PLANS)
def test_plans_begin_with_the_fewest_cells_that_may_suffice(own, expected):
    notebook = lesson(**own)
    found = list(plans(notebook, find_exercises(notebook)[0]))
    assert [plan.why for plan in found] == expected


@pytest.mark.parametrize('own', [own for own, _ in PLANS.values()], ids=PLANS)
def test_every_plan_is_in_order_and_contains_the_cells_of_its_exercise(own):
    notebook = lesson(**own)
    for exercise in find_exercises(notebook):
        for plan in plans(notebook, exercise):
            assert list(plan.cells) == sorted(set(plan.cells))
            assert {exercise.reset, exercise.answer, *exercise.run} <= set(plan.cells)
            assert not {notebook.cells[i].source for i in plan.cells} & {'check()', '# A lesson'}


SHOWN = new_notebook(
    cells=[
        new_code_cell('import math'),
        *(
            new_code_cell(source, metadata={'tags': ['demo']})
            for source in (
                'np = 1', 'joints = 0', 'joints = np', 'listener = run(joints)', 'unused = 2'
            )
        ),
        marked('area-reset', "reset('area')"),
        answer('area'),
        new_code_cell('# try it'),
        grade('area-visible'),
        new_code_cell('late = np', metadata={'tags': ['demo']}),
    ]
)  # fmt: skip
BORROWED = {
    'a name in a function': ('def area(r): return np', ['np = 1']),
    'in a method': ('class area:\n    def go(self): return np', ['np = 1']),
    'the last of several before it, and what that needs': (
        'area = lambda r: joints', ['np = 1', 'joints = np'],
    ),
    'all that they need': (
        'def area(r): return listener', ['np = 1', 'joints = np', 'listener = run(joints)'],
    ),
    'one that is shown below': ('def area(r): return late', ['np = 1', 'late = np']),
    'beside a star import': ('from math import *\ndef area(r): return np', ['np = 1']),
    'a name of its own': ('np = 3\ndef area(r): return np', []),
    'nothing': ('def area(r): return math.pi', []),
    'a name that its text tells': ('def area(r): return getattr(math, "pi")', []),
    'a name that nobody binds': ('def area(r): return tau', []),
}  # fmt: skip


@pytest.mark.parametrize(('area', 'expected'), BORROWED.values(), ids=BORROWED)
def test_demonstrations_that_bind_names_of_an_answer_are_run(area, expected):
    template = make_template(nbformat.from_dict(SHOWN), nbformat.from_dict(SHOWN))
    submitted = nbformat.from_dict(SHOWN)
    next(
        c for c in submitted.cells if c.metadata.get('nbgrader', {}).get('solution')
    ).source = area
    notebook = restore(submitted, template).notebook
    first = next(plans(notebook, find_exercises(notebook)[0]))
    assert [notebook.cells[i].source for i in first.demonstrations] == expected
    own = ["reset('area')", area]
    assert sorted(sources(notebook, first)) == sorted(['import math', *expected, *own])


@pytest.mark.parametrize(
    'area',
    ['def area(r): return eval("np")', 'area = lambda r: globals()["np"]', 'import __main__ as m'],
)
def test_all_earlier_demonstrations_run_if_an_answer_looks_names_up_indirectly(area):
    notebook = lesson(area=area, at_start='early = 1', at_end='late = 2')
    exercise, _ = find_exercises(notebook)
    first = next(plans(notebook, exercise))
    assert first.why == 'with all that the lesson shows'
    assert sources(notebook, first) == ['import math', 'shown = 1', "reset('area')", area]
    assert first.demonstrations == ()


@pytest.mark.parametrize(
    ('name', 'expected'),
    [
        ('shown', ['import math', 'shown = 1']),
        ('late', ['import math', 'shown = 1', 'late = 2']),
        ('math', None),  # it was run
        ('nobody', None),
        ('cmath', None),  # the lesson comes to it later
        ('area', None),
    ],
)
def test_a_plan_for_missing_names_adds_the_cells_that_bind_them(name, expected):
    notebook = lesson(area='area = 1', at_end='late = 2')
    exercise, _ = find_exercises(notebook)
    plan = plan_for_names(notebook, exercise, next(plans(notebook, exercise)), {name})
    if expected is None:
        assert plan is None
    else:
        own = ["reset('area')", 'area = 1']
        assert sorted(sources(notebook, plan)) == sorted([*expected, *own])


def test_a_plan_for_a_name_that_must_not_be_known_adds_all_cells_that_bind_any():
    notebook = lesson(area='area = 1', at_start='print(1)', at_end='late = 2')
    exercise, _ = find_exercises(notebook)
    plan = plan_for_names(notebook, exercise, next(plans(notebook, exercise)), None)
    assert {'shown = 1', 'late = 2'} <= {*sources(notebook, plan)}
    assert 'print(1)' not in sources(notebook, plan)


def test_a_lent_helper_brings_the_demonstrations_that_it_needs():
    notebook = lesson(area='def area(r): return h(r)', at_start='def h(r): return shown')
    first = next(plans(notebook, find_exercises(notebook)[0]))
    assert first.why == LENT
    assert [notebook.cells[i].source for i in first.demonstrations] == ['shown = 1']


@pytest.mark.timeout(60)
def test_demonstrations_that_need_one_another_are_run_once():
    notebook = lesson(area='area = ping')
    [ping] = [cell for cell in notebook.cells if cell.source == 'shown = 1']
    pong = nbformat.from_dict(ping)
    ping.source, pong.source = 'ping = pong', 'pong = ping'
    notebook.cells.insert(notebook.cells.index(ping), pong)
    first = next(plans(notebook, find_exercises(notebook)[0]))
    shown = [notebook.cells[i].source for i in first.demonstrations]
    assert shown == ['pong = ping', 'ping = pong']


def test_a_chain_of_700_cells_is_planned_within_a_second():
    notebook = lesson(area='def area(r): return v0', at_start='# many')
    [many] = [cell for cell in notebook.cells if cell.source == '# many']
    at = notebook.cells.index(many)
    for number in range(700):
        more = ''.join(f'w{number}x{each}=u{number}x{each}\n' for each in range(20))
        cell = nbformat.from_dict(many)
        cell.source = f'v{number} = v{number + 1}\n{more}'
        notebook.cells.insert(at, cell)
    found = list(plans(notebook, find_exercises(notebook)[0]))
    began = time.process_time()  # all texts have been read before
    assert list(plans(notebook, find_exercises(notebook)[0])) == found
    assert time.process_time() - began < 1.0
    assert [plan.why for plan in found] == [LENT, WHOLE]
    assert len(found[0].cells) > 700


def sources(notebook, plan):
    return [notebook.cells[i].source for i in plan.cells]


def test_each_plan_runs_the_expected_cells_in_order():
    notebook = lesson(at_start='early = 1', at_end='late = 2')
    alone, others, whole = (
        sources(notebook, p) for p in plans(notebook, find_exercises(notebook)[1])
    )
    node = 'class Talker: pass\nrate_hz = 5'
    own = ["reset('Talker', 'rate_hz')", node, "run_answer('Talker')"]
    assert alone == ['import math', 'import cmath', *own]
    assert others == [
        'early = 1', 'import math', 'def area(r): return r', '# try it', 'import cmath', *own,
        '# try that',
    ]  # fmt: skip
    assert whole == [
        'early = 1', 'import math', 'shown = 1', 'def area(r): return r', '# try it',
        'import cmath', *own, '# try that', 'late = 2',
    ]  # fmt: skip


@pytest.mark.parametrize('area', ['def area(r): return r', 'area = eval("abs")'])
@pytest.mark.parametrize('magic', ['%%bash', '%%write_node x.py'])
def test_no_plan_writes_or_runs_a_program_of_the_lesson(magic, area):
    notebook = lesson(area=area)
    shown = next(cell for cell in notebook.cells if cell.source == 'shown = 1')
    shown.source = f'{magic}\nx = 1'
    for exercise in find_exercises(notebook):
        for plan in plans(notebook, exercise):
            assert shown.source not in sources(notebook, plan), plan.why


def test_a_lent_later_cell_does_not_bring_cells_of_other_exercises():
    notebook = lesson(area='area = h', node='rate_hz = 1', at_end='h = 2')
    others = next(plans(notebook, find_exercises(notebook)[0]))
    assert 'h = 2' in sources(notebook, others)
    assert 'rate_hz = 1' not in sources(notebook, others)


HELPER = 'def helper(): return 2'
LATE = {
    'nothing': ('x = 1', '', False),
    'a helper below': ('x = helper', HELPER, True),
    'a helper below that a method needs': (
        'class Talker:\n    def go(self): return helper()', HELPER, True,
    ),
    'one that is bound in a try': ('x = helper', 'try:\n    import helper\nexcept E: pass', True),
    'a star import below': ('x = helper', 'from helpers import *', True),
    'one of its own': (HELPER, HELPER, False),
    'what the helper needs': ('x = h', 'h = lambda: k\nk = 1', True),
    'another name': ('x = 1', HELPER, False),
    'the answer itself': ('', 'class Talker: pass\nrate_hz = 5', False),
}  # fmt: skip


@pytest.mark.parametrize(('node', 'below', 'is_late'), LATE.values(), ids=LATE)
def test_the_run_cell_runs_again_if_a_name_of_the_answer_is_bound_later(node, below, is_late):
    notebook = lesson(node=node, at_end=below)
    exercise = find_exercises(notebook)[1]
    for plan in plans(notebook, exercise):
        if below in sources(notebook, plan):
            assert plan.again == (exercise.run if is_late else ())


def test_a_helper_that_needs_a_later_helper_counts_as_later():
    notebook = lesson(node='x = above', at_start='def above(): return below', at_end='below = 1')
    exercise = find_exercises(notebook)[1]
    assert [plan.again for plan in plans(notebook, exercise)] == [exercise.run] * 2


def test_a_helper_bound_both_earlier_and_later_does_not_count_as_later():
    notebook = lesson(node='x = helper', at_start=HELPER, at_end='helper = 3')
    exercise = find_exercises(notebook)[1]
    assert {plan.again for plan in plans(notebook, exercise)} == {()}


def test_the_run_cell_runs_again_if_a_missing_name_is_bound_later():
    notebook = lesson(node='x = getattr(m, "late")', at_end='late = 2')
    exercise = find_exercises(notebook)[1]
    plan = plan_for_names(notebook, exercise, next(plans(notebook, exercise)), {'late'})
    assert plan.again == exercise.run


@pytest.mark.parametrize('lender', ['exec("k = 1")', '%run helpers.py', 'globals()["k"] = 1'])
def test_a_cell_that_may_bind_any_name_is_lent(lender):
    notebook = lesson(area='def area(r): return k', at_start=lender)
    assert next(plans(notebook, find_exercises(notebook)[0])).why == LENT


@pytest.mark.parametrize(
    ('cells', 'is_misspelled'),
    [
        ({}, True),
        ({'area': 'tua = 2'}, True),
        ({'at_end': 'tau = 2'}, True),
        ({'at_end': 'tua = 2'}, False),
        ({'try_it': 'setattr(here, "tua", 2)'}, False),
        ({'at_end': 'tua = ('}, False),
        ({'at_start': 'from math import *'}, False),
        ({'at_start': '%pylab inline'}, False),
        ({'at_start': '%%time\ntau = 2'}, True),
    ],
)
def test_a_name_counts_as_misspelled_if_no_other_cell_may_bind_it(cells, is_misspelled):
    notebook = lesson(**cells)
    exercise = find_exercises(notebook)[0]
    assert are_misspelled({'tua'}, notebook, exercise) == is_misspelled
