"""Which names a cell binds and needs, read from its text."""

import time

import pytest
from IPython.core import inputtransformer2
from IPython.core.inputtransformer2 import make_tokens_by_line
from my_robot_basics.validate.lessons.names import (
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
    'augmented': ('x += 1', '', 'x'),
    'augmented once it is there': ('x = 0\nx += 1', 'x', ''),
    'augmented in a function': ('def f():\n    global x\n    x += 1', 'f', 'x'),
    'set in a function that reads it': (
        'def f():\n    global x\n    if x: x = 1', 'f x', 'x',
    ),
    'deleted': ('del x', '', 'x'),
    'declared': ('x: int', '', ''),
    'annotated': ('x: T = 3', 'x', 'T'),
    'in a try': ('try:\n    import a\nexcept E:\n    a = None', 'a', 'E'),
    'a function in an if': ('if x:\n    def h(): return k', 'h', 'x k'),
    'a loop over several': ('for i, (j, *k) in z: pass', 'i j k', 'z'),
    'a walrus in a while': ('while m := f(): pass', 'm', 'f'),
    'a walrus in a comprehension': ('[y := i for i in z]', 'y', 'z'),
    'all patterns': (
        'match v:\n    case [a, *b]: pass\n    case {**r}: pass\n    case P(x=q) as s: pass',
        'a b r q s', 'v P',
    ),
    'of a class body': ('class A:\n    h = 1\n    def f(self): return h', 'A', 'h'),
    'set globally in a class body': ('class A:\n    global h\n    h = 1', 'A h', ''),
    'a name of a comprehension and of a function': (
        'def h(): pass\nx = [h for h in y]', 'h x', 'y',
    ),
    'a name of a comprehension and of an import': (
        'import h\nx = [h for h in y]', 'h x', 'y',
    ),
    'a name of a comprehension, and from elsewhere': ('x = [h for h in y]\nh()', 'x', 'y h'),
    'a comprehension over its own name': ('[x for x in x]', '', 'x'),
    'comprehensions in comprehensions': ('[[j for j in i] for i in z]', '', 'z'),
    'in a lambda of a comprehension': ('f = [lambda: i + k for i in z]', 'f', 'z k'),
    'a default, a decorator, a base and a metaclass': (
        '@d\nclass C(B, metaclass=M):\n    def f(self, a=q): pass', 'C', 'd B M q',
    ),
    'builtins and IPython': ('display(len(In), get_ipython(), _)', '', ''),
    'a star import may bring some': ('from math import *\ny = sin(x)', 'y', 'sin x'),
    'a line magic': ('%matplotlib inline\nx = y', 'x', 'y'),
    'a shell line': ('out = !ls {d}\nx = 1', 'out x', ''),
    'a cell magic': ('%%bash\necho $x', '', ''),
    'a cell that is timed': ('%%time\ndef h(): return k', 'h', 'k'),
    'a cell whose output is kept': ('%%capture out\nh = k\n!ls', 'h', 'k'),
    'a line that is timed': ('if x:\n    %time h = f()', 'h', 'x f'),
    'a line that is timed for itself': ('%time\nh = 1', 'h', ''),
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
def test_names_that_a_cell_binds_and_needs_are_found(source, bound, needed):
    names = names_of(source)
    assert (names.bound, names.needed) == (set(bound.split()), set(needed.split()))


@pytest.mark.parametrize('before', [')', 'x = 1'])
def test_many_empty_lines_are_read_within_half_a_second(before):
    names_of.cache_clear()
    began = time.process_time()
    names_of(before + '\n' * (MAX_SOURCE_CHARACTERS - len(before)))
    assert time.process_time() - began < 0.5


@pytest.mark.parametrize(
    'source',
    ['from math import *', '%run helper.py', 'x = 1\nexec("h = 1")', 'globals()["h"] = 1'],
)
def test_cells_that_may_bind_any_name_are_marked(source):
    assert names_of(source).binds_more


def test_an_import_of_names_is_not_marked_as_binding_any_name():
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
def test_cells_that_look_names_up_by_other_means_are_marked(source):
    assert names_of(source).needs_more


@pytest.mark.parametrize(
    'source', ['def f(): return getattr(np, "pi")', 'evaluate(x)', 'x = "in the main program"']
)
def test_cells_with_ordinary_names_are_not_marked(source):
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
def test_missing_names_are_read_from_an_error_message(said, names):
    assert names_not_defined(said) == names


def test_reading_a_cell_runs_no_code_of_the_cell(capfd):
    names_of('print("ran")\n!echo ran\nraise SystemExit')
    assert capfd.readouterr() == ('', '')


@pytest.fixture
def tokenized(monkeypatch):
    """An item for each time that IPython has read all of a cell."""
    times = []
    monkeypatch.setattr(
        inputtransformer2,
        'make_tokens_by_line',
        lambda lines: times.append(1) or make_tokens_by_line(lines),
    )
    names_of.cache_clear()
    return times


@pytest.mark.parametrize('line', ['a?', '%a', '!a', 'a=%b', ',f a'])
def test_a_cell_with_very_many_magics_is_not_read(line, tokenized):
    """IPython would read all of the cell anew for each of them, and give up after 500."""
    assert names_of(f'{line}\n' * 600) == Names()
    assert tokenized == []
    assert names_of(f'x = 1\n{line}\n').bound >= {'x'}


@pytest.mark.parametrize(('more', 'is_read'), [(0, True), (1, False)])
def test_a_long_cell_with_a_magic_is_not_read(more, is_read, tokenized):
    source = 'x = 1\n!ls\n#'
    names = names_of(source + 'a' * (MAX_IPYTHON['characters'] - len(source) + more))
    assert ('x' in names.bound, tokenized != []) == (is_read, is_read)


@pytest.mark.parametrize('text', [';', ',', '\t;'])
def test_a_cell_that_ipython_reads_again_and_again_is_given_up_soon(text, tokenized):
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
def test_string_arguments_of_a_call_are_found(source, expected):
    assert string_arguments(source, 'reset') == expected
