"""A check of an exercise that nobody has answered yet says so, in the notebook and in Validate."""

import json
import os
import subprocess
import sys

import nbformat
import pytest
from answered import ROOT, read, students_environment
from jupyter_client.manager import start_new_kernel
from my_robot_basics.validate.lessons.lesson import read_lesson
from my_robot_basics.validate.verdicts.unanswered import explain_unanswered, is_unanswered
from my_robot_basics.validate.verdicts.verdict import Verdict

from grader.notebook.restore import make_template, restore

LESSON = '00_two_link_arm'
SAID = (
    'expected an answer to `reach`, saw none yet: '
    'write it into the answer cell `reach`, where it says YOUR CODE HERE'
)
WRONG = 'def is_reachable(x, y, l1, l2):\n    print(x)'
COMMENTED = '# mine\n'


class Notebook:
    """A lesson in a kernel, opened as JupyterLab opens it."""

    def __init__(self, path):
        clean = {k: v for k, v in os.environ.items() if not k.startswith(('PYTEST_', 'MY_ROBOT_'))}
        self.cells = {cell.id: cell.source for cell in nbformat.read(path, as_version=4).cells}
        self.manager, self.client = start_new_kernel(
            kernel_name='python3', env=clean | {'JPY_SESSION_NAME': str(path)}
        )

    def run(self, name, source=None):
        """Run a cell; return its traceback in one line, or ''."""
        content = {
            **{'code': self.cells[name] if source is None else source, 'silent': False},
            **{'store_history': True, 'user_expressions': {}, 'allow_stdin': False},
        }
        message = self.client.session.msg('execute_request', content, metadata={'cellId': name})
        self.client.shell_channel.send(message)
        while (reply := self.client.get_shell_msg(timeout=60))['parent_header'].get(
            'msg_id'
        ) != message['header']['msg_id']:
            pass
        return ' '.join(' '.join(reply['content'].get('traceback', ())).split())

    def close(self):
        self.client.stop_channels()
        self.manager.shutdown_kernel(now=True)


@pytest.fixture(scope='module')
def notebook():
    opened = Notebook(ROOT / 'notebooks' / LESSON / f'{LESSON}.ipynb')
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
