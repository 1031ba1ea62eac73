"""Code that Python cannot parse is quoted with its line, and usual mistakes are explained."""

import re

import pytest
from jupyter_client.manager import start_new_kernel
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.verdicts.trouble import MOST_OF_A_LINE, describe_cell_error
from nbformat.v4 import new_output

EQUALS = ', so write <= or >=, with the equals sign last'
WORDS = ', so write the words `and`, `or` and `not`'
COUNT = ', so write += 1 or -= 1 to count'
DEEPER = ', so begin the lines of that block with four more spaces; a block without a '
SPACES = ', so let all lines of a block begin with equally many spaces'


@pytest.fixture(scope='module')
def kernel():
    manager, client = start_new_kernel(kernel_name='python3')
    yield client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


def told_of(**error):
    return describe_cell_error('a', CellRun(error=new_output('error', **error)))


@pytest.mark.starts
@pytest.mark.parametrize(
    ('code', 'line', 'why'),
    [
        ('if x =< 2:\n    pass', 'line 1: if x =< 2:', EQUALS),
        ('x = 0\nx++', 'line 2: x++', COUNT),
        ('if a && b:\n    pass', 'line 1: if a && b:', WORDS),
        ('if !ready:\n    pass', 'line 1: if !ready:', WORDS),
        (
            'if a:\n    pass\nelse if b:\n    pass',
            'line 3: else if b:',
            ', so write elif in place of else if',
        ),
        ('  x = 1\n y = 2', 'line 1: x = 1', SPACES),
        ('if a:\n    x = 1\n  y = 2', 'line 3: y = 2', SPACES),
        ('def f(self):\nx = 1', 'line 2: x = 1', DEEPER),
        ('def f(self):\n    # later\nx = 1', 'line 3: x = 1', DEEPER),
        ('print(f(1)', 'line 1: print(f(1)', ''),
        ('def f()\n    pass', 'line 1: def f()', ''),
        # these signs are part of a text or a comment, and not what is wrong
        ("print('--- x => y && !z'", "line 1: print('--- x => y && !z'", ''),
        ("x = 1 print('--')", "line 1: x = 1 print('--')", ''),
        ('x = 1 y # a && b', 'line 1: x = 1 y # a && b', ''),
    ],
)
def test_code_that_python_cannot_parse_is_quoted_and_explained(code, line, why, kernel):
    said = kernel.execute_interactive(code, output_hook=lambda message: None)['content']
    told = told_of(**{key: said[key] for key in ('ename', 'evalue', 'traceback')})
    assert re.match(r'your cell `a` stopped with \w+Error: ', told)
    assert (f'({line}){why}' in told) if why else told.endswith(f'({line})')


def test_the_last_line_with_a_caret_is_quoted():
    traceback = [
        'Cell In[1], line 1\n    eval("1 +")\n    ^\n  File <string>:1\n    1 +\n       ^'
    ]
    told = told_of(ename='SyntaxError', evalue='bad (<string>, line 1)', traceback=traceback)
    assert told.endswith('bad (line 1: 1 +)')


def test_a_long_line_is_quoted_in_part_and_once():
    """A traceback comes from the student's kernel: it may hold anything, of any length."""
    evalue = 'bad (1.py, line 1)'
    told = told_of(ename='SyntaxError', evalue=evalue, traceback=['x' * 1_000_000 + '\n ^'])
    assert told.endswith(f'bad (line 1: {"x" * MOST_OF_A_LINE})')
    many = told_of(
        ename='SyntaxError', evalue=evalue * 20_000, traceback=['x' * 1_000_000 + '\n^']
    )
    assert many.count('line 1: ') == 1
