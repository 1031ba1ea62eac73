"""Which names a cell binds and needs, read from its text."""

import pytest
from IPython.core import inputtransformer2
from IPython.core.inputtransformer2 import make_tokens_by_line
from my_robot_basics.validate.names import (
    MAX_IPYTHON,
    MAX_SOURCE_CHARACTERS,
    Names,
    names_not_defined,
    names_of,
    string_arguments,
)

CELLS = {
    'nothing': ('', '', ''),
    'an assignment': ('x = y', 'x', 'y'),
    'several at once': ('a, (b, *c) = d', 'a b c', 'd'),
    'an import': ('import math\nimport os.path as p', 'math p', ''),
    'a from-import': ('from rclpy.node import Node as N, T', 'N T', ''),
    'a dotted import': ('import rclpy.node', 'rclpy', ''),
    'a function': ('def f(x, y=k):\n    z = x\n    return z + h', 'f', 'k h'),
    'a decorator': ('@wrap\ndef f(): pass', 'f', 'wrap'),
    'a class': ('class A(Node):\n    rate = HZ\n    def go(self): self.x = H()', 'A', 'Node HZ H'),
    'an annotation': ('def f(x: Pose) -> Time: pass', 'f', 'Pose Time'),
    'recursion needs nothing': ('def f(): return f()', 'f', ''),
    'a global set in a function': ('def f():\n    global x\n    x = 1', 'f x', ''),
    'a closure': ('def f():\n    x = 1\n    def g(): return x\n    return g', 'f', ''),
    'a comprehension': ('[i for i in items if i in allowed]', '', 'items allowed'),
    'a lambda': ('f = lambda x: x + k', 'f', 'k'),
    'a walrus': ('print(x := 3)', 'x', ''),
    'a for loop': ('for i in range(3): print(i)', 'i', ''),
    'an exception': ('try: go()\nexcept Oops as e: print(e)', 'e', 'go Oops'),
    'with': ('with open(p) as f: f.read()', 'f', 'p'),
    'a match': ('match v:\n    case {"k": w}: print(w)', 'w', 'v'),
    'an f-string': ("print(f'{x!r:>{w}}')", '', 'x w'),
    'augmented': ('x += 1', 'x', ''),
    'deleted': ('del x', 'x', ''),
    'builtins and IPython': ('display(len(In), get_ipython(), _)', '', ''),
    'a star import may bring some': ('from math import *\ny = sin(x)', 'y', 'sin x'),
    'a line magic': ('%matplotlib inline\nx = y', 'x', 'y'),
    'a shell line': ('out = !ls {d}\nx = 1', 'out x', ''),
    'a cell magic': ('%%bash\necho $x', '', ''),
    'a question': ('math?', '', ''),
    'an await': ('x = await y', 'x', 'y'),
    'a syntax error': ('def f(:\n  pass', '', ''),
    'an unfinished string': ("x = 'a", '', ''),
    'a NUL': ('x = 1\0', '', ''),
    'another alphabet': ('θ = 角度', 'θ', '角度'),
    'nested too deep': ('-' * 50_000 + 'x', '', ''),
    'a sum too long': ('1+' * 50_000 + 'x', '', ''),
    'brackets too deep': ('(' * 5_000 + 'x' + ')' * 5_000, '', ''),
    'functions in functions': ('lambda:' * 2_700 + 'x', '', 'x'),
    'functions in functions, and nothing': ('lambda:' * 2_700, '', ''),
    'too long': ('x = 1\n' + '#' * MAX_SOURCE_CHARACTERS, '', ''),
}  # fmt: skip


@pytest.mark.parametrize(('source', 'bound', 'needed'), CELLS.values(), ids=CELLS)
def test_names_of_a_cell(source, bound, needed):
    names = names_of(source)
    assert (names.bound, names.needed) == (set(bound.split()), set(needed.split()))


def test_a_star_import_binds_more_than_is_told():
    assert names_of('from math import *').binds_more
    assert not names_of('from math import sin\nimport cmath').binds_more


@pytest.mark.parametrize(
    'source',
    [
        'def f(): return eval("np").pi',
        'f = lambda: globals()["np"]',
        'def f(): exec("x = np")',
        'def f(): return vars()',
        'import sys\ndef f(): return getattr(sys.modules["__main__"], "np")',
        'import __main__',
        'from __main__ import np',
        'get_ipython().user_ns["np"]',
    ],
)
def test_names_that_are_looked_up_by_other_means_are_not_known(source):
    assert names_of(source).needs_more


@pytest.mark.parametrize(
    'source', ['def f(): return getattr(np, "pi")', 'evaluate(x)', 'x = "in the main program"']
)
def test_ordinary_names_are_known(source):
    assert not names_of(source).needs_more


@pytest.mark.parametrize(
    ('said', 'names'),
    [
        ("saw NameError: name 'np' is not defined: call", {'np'}),
        ("its callback raised KeyError: 'np' (line 3", {'np'}),
        ("AttributeError: module '__main__' has no attribute 'np'", {'np'}),
        ("ValueError: 'np', name 'np'", set()),
    ],
)
def test_names_that_an_error_says_are_missing(said, names):
    assert names_not_defined(said) == names


def test_reading_a_cell_runs_none_of_it(capfd):
    names_of('print("ran")\n!echo ran\nraise SystemExit')
    assert capfd.readouterr() == ('', '')


@pytest.mark.parametrize('line', ['a?', '%a', '!a', 'a=%b', ',f a'])
def test_magics_beyond_number_are_not_read(line):
    """IPython would read all of the cell anew for each of them, and give up after 500."""
    assert names_of(f'{line}\n' * 600) == Names()
    assert names_of(f'x = 1\n{line}\n').bound >= {'x'}


@pytest.mark.parametrize('text', [';', ',', '\t;'])
def test_what_ipython_reads_again_and_again_is_left_soon(text, monkeypatch):
    tokenized = []
    monkeypatch.setattr(
        inputtransformer2,
        'make_tokens_by_line',
        lambda lines: tokenized.append(1) or make_tokens_by_line(lines),
    )
    assert names_of(f'x = 1\n{text * 700}\n') == Names()
    assert len(tokenized) <= 2 * MAX_IPYTHON['lines']


ARGUMENTS = {
    'one': ("reset('five_hz')", ('five_hz',)),
    'several': ("reset('a', 'b')", ('a', 'b')),
    'none': ('reset()', ()),
    'other calls': ("print('a'); live.reset('b')", ()),
    'not a text': ("reset(x, 1, 'a')", ('a',)),
}


@pytest.mark.parametrize(('source', 'expected'), ARGUMENTS.values(), ids=ARGUMENTS)
def test_string_arguments_of_a_call(source, expected):
    assert string_arguments(source, 'reset') == expected
