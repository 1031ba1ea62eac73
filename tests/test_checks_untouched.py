"""A check of an exercise that has no answer that runs says so, in the notebook and in Validate."""

import json
import subprocess
import sys

import nbformat
import pytest
from answered import ROOT, read, students_environment
from my_robot_basics.checks.clock.tick import PASSED
from my_robot_basics.feedback.unanswered import say_stopped
from my_robot_basics.language.speaking import in_language
from my_robot_basics.validate.lessons.lesson import read_lesson
from my_robot_basics.validate.verdicts.unanswered import explain_unanswered, is_unanswered
from my_robot_basics.validate.verdicts.verdict import Verdict
from opened_lesson import OpenedLesson

from grader.notebook.restore import make_template, restore

LESSON = '00_two_link_arm'
SAID = (
    'expected an answer to `reach`, saw none yet: '
    'write it into the answer cell `reach`, where it says YOUR CODE HERE'
)
WRONG = 'def is_reachable(x, y, l1, l2):\n    print(x)'
COMMENTED = '# mine\n'
RIGHT = (
    'def is_reachable(x, y, l1, l2):\n    return abs(l1 - l2) <= (x * x + y * y) ** 0.5 <= l1 + l2'
)
STOPPED = (
    'expected the answer cell `reach` to run to its end, saw {}: '
    'correct `reach` and run it, then run this cell again'
)


@pytest.fixture(scope='module')
def notebook():
    opened = OpenedLesson(ROOT / 'notebooks' / LESSON / f'{LESSON}.ipynb')
    yield opened
    opened.close()


def check_of(notebook, answer):
    for name, source in {'imports': None, 'reach-reset': None, 'reach': answer}.items():
        assert notebook.run(name, source) == ''
    return notebook.run('reach-visible')


def test_the_check_of_an_untouched_cell_says_that_there_is_no_answer(notebook):
    assert check_of(notebook, None) == SAID


@pytest.mark.parametrize('answer', [WRONG, COMMENTED], ids=['wrong', 'commented'])
def test_once_the_cell_is_changed_its_checks_say_what_is_wrong(notebook, answer):
    said = check_of(notebook, answer if answer == WRONG else answer + notebook.cells['reach'])
    assert 'to return a value, saw None' in said


@pytest.mark.parametrize('before', [WRONG, RIGHT], ids=['wrong', 'right'])
@pytest.mark.parametrize(
    ('answer', 'saw'),
    [
        (RIGHT.replace('):', ')'), "`SyntaxError: expected ':'`"),
        (
            'limit = 1.8\n' + RIGHT + '\nis_reachable(1, 1, lenght, 1)',
            "it raised `NameError: name 'lenght'",
        ),
    ],
    ids=['syntax', 'name'],
)
def test_a_check_does_not_judge_what_an_answer_cell_that_stopped_has_left(
    notebook, before, answer, saw
):
    check_of(notebook, before)
    assert notebook.run('reach', answer) != ''
    said = notebook.run('reach-visible') or notebook.printed
    start, _, end = STOPPED.partition('{}')
    assert said.startswith(start + saw)
    assert said.endswith(end)
    assert check_of(notebook, RIGHT) == ''
    assert notebook.printed == PASSED


def test_a_check_in_an_unknown_notebook_judges_although_the_cell_before_it_raised():
    """Only JupyterLab tells a kernel its notebook and the ids of cells."""
    program = (
        'from IPython.core.interactiveshell import InteractiveShell\n'
        'from my_robot_basics.checks import fail\n'
        'from my_robot_basics.live.extension import load_ipython_extension\n'
        'shell = InteractiveShell.instance()\n'
        'shell.kernel = None\n'
        "shell.user_ns['fail'] = fail\n"
        'load_ipython_extension(shell)\n'
        "for seen in 'one', 'two':\n"
        "    shell.run_cell(f'fail(expected=str(), seen={seen!r}, hint=str())')\n"
    )
    run = [sys.executable, '-P', '-c', program]
    told = subprocess.run(run, env=students_environment(), capture_output=True, text=True)
    assert [told.stdout.count(f'saw {seen}') for seen in ('one', 'two')] == [1, 1], told


@pytest.mark.parametrize(
    ('error', 'shown'),
    [
        ("SyntaxError: expected ':'", "`SyntaxError: expected ':'`"),
        (
            "NameError: name 'tru' is not defined",
            "它抛出了 `NameError: name 'tru' is not defined`，请先",
        ),
    ],
)
def test_a_chinese_notebook_says_it_in_chinese(error, shown):
    said = in_language('zh_CN', say_stopped('reach', error))
    assert said.startswith(f'预期：答案单元格 `reach` 运行到结束；实际：{shown}')
    assert said.endswith('请改正 `reach` 并运行它，然后再运行这个单元格')


def test_validate_says_so_in_the_checks_and_names_the_cell():
    path = ROOT / 'notebooks' / LESSON / f'{LESSON}.ipynb'
    run = [sys.executable, '-P', '-m', 'my_robot_basics.validate', '--json', str(path)]
    told = subprocess.run(run, env=students_environment(), capture_output=True, check=False)
    report = json.loads(told.stdout.splitlines()[-1])['report']
    messages = [check['message'] for part in report['parts'] for check in part['checks']]
    number = 1 + next(i for i, c in enumerate(read('notebooks', LESSON).cells) if c.id == 'reach')
    assert messages == [
        SAID.replace('the answer cell `reach`', f'cell {number} (the answer to `reach`)'),
        '',
    ]


def failed(reason='', **more):
    return Verdict('reach-visible', 'failed', 1.0, reason, **more)


def explained(cell, verdict):
    [(told, outputs)] = explain_unanswered(cell, {7: (verdict, [])}).values()
    assert outputs == []
    return told


def answer_of(path):
    return next(c for c in read_lesson(path).notebook.cells if c.id == 'reach')


def test_validate_explains_what_fails_without_an_answer_and_nothing_else(tmp_path):
    cell = answer_of(ROOT / 'notebooks' / LESSON / f'{LESSON}.ipynb')
    notes = ('your cell `reach-run` stopped', 'a remark')
    told = explained(cell, failed('saw None', notes=notes))
    assert (told.reason, told.notes, told.score) == (SAID, ('a remark',), 0.0)
    assert SAID.endswith(told.hint)
    passed = Verdict('reach-visible', 'passed', 1.0, '')
    assert explained(cell, passed) == passed
    notebook = read('notebooks', LESSON)
    next(c for c in notebook.cells if c.id == 'reach').source += '\n    print(x)'
    nbformat.write(notebook, tmp_path / 'own.ipynb')
    assert explained(answer_of(tmp_path / 'own.ipynb'), failed('saw None')) == failed('saw None')


def test_code_to_fix_is_no_missing_answer():
    cells = read_lesson(ROOT / 'notebooks/07_common_errors/07_common_errors.ipynb').notebook.cells
    assert not any(map(is_unanswered, cells))


@pytest.mark.parametrize(('text', 'is_one'), [('', True), ('\n    print(x)', False)])
def test_the_grader_says_the_same(text, is_one):
    release = read('notebooks', LESSON)
    submitted = read('notebooks', LESSON)
    next(c for c in submitted.cells if c.id == 'reach').source += text
    restored = restore(submitted, make_template(read('solutions', LESSON), release)).notebook
    assert is_unanswered(next(c for c in restored.cells if c.id == 'reach')) == is_one
