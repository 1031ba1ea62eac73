"""What a student's room may try against the checks: replies, patches, a search for the test."""

import asyncio
import json

import pytest
from my_robot_basics.validate.kernels.outputs import CellRun
from two_rooms import check_in, opened_rooms, said, student_in, text_of

from grader.kernels import rooms as module
from grader.kernels.rooms import GradingRooms


@pytest.fixture
def rooms(loop):
    """Rooms for one test alone."""
    with opened_rooms(loop) as rooms:
        yield rooms


@pytest.fixture
def student(loop):
    return student_in(loop)


@pytest.fixture
def check(loop):
    return check_in(loop)


ASK = """
from my_robot_basics.checks import student
print(student.value('x'))
"""
REPLIES = {
    'a forged reply': ("""'{"ok": 42}'""", '42\n'),
    'two answers': ("""'{"ok": 1, "failed": "x"}'""", 'not exactly one answer'),
    'another tag': ("""'{"ok": {"pickle": "x"}}'""", 'unknown tag'),
    'nested': ("""'{"ok":' + '[' * 20_000""", 'not the JSON of a reply'),
    'no JSON': ('"print(1)"', 'not the JSON of a reply'),
    'a number': ('5', 'no usable answer'),
    'bytes': ('b"x"', 'no usable answer'),
    'Python': ("""Shown("'a' + 'b'")""", 'no usable answer'),
    'deep Python': ('Shown("-" * 60_000 + "1")', 'no usable answer'),
    'an escape that is none': (r"""Shown(r"'\x'")""", 'no usable answer'),
    'an escape that would be warned of': (r"""Shown(r"'\q'")""", 'no usable answer'),
    'a character that ends Python': (r"""Shown("'\0'")""", 'no usable answer'),
    'half a character': (r"""Shown(r"'\ud800'")""", 'no usable answer'),
    '10 MB': ('"x" * 10_000_000', 'an answer of 10,000,002 characters'),
    'raises': ('1 / 0', 'no usable answer'),
    'exits': ('exec("raise SystemExit")', 'no usable answer'),
}
SHOWN = """
from my_robot_basics.exchange import responder
x = 1
class Shown:
    def __init__(self, text): self.text = text
    def __repr__(self): return self.text
"""
PATCHES = {
    'no module': 'import sys; sys.modules["my_robot_basics.exchange.responder"] = None',
    'other expressions': 'ip = get_ipython(); ip.user_expressions = lambda e: {"reply": {}}',
    'expressions of another shape': 'ip.user_expressions = lambda e: [7]',
}


def test_a_hostile_reply_does_no_more_than_fail_its_check(rooms, student, check):
    student(rooms, SHOWN)
    cases = {name: (f'responder.answer = lambda r: {r}', e) for name, (r, e) in REPLIES.items()}
    cases |= {name: (code, 'no usable answer') for name, code in PATCHES.items()}
    for name, (code, expected) in cases.items():
        student(rooms, code)
        result = check(rooms, ASK)
        assert expected in said(result), name
        assert result.error is None or result.error.ename == 'CheckFailed', name
    assert rooms.student_alive


ATTACKS = """
import builtins, sys
builtins.AssertionError = builtins.print
builtins.input = lambda p: '{"ok": 1}'
import rclpy, rclpy.node, my_robot_basics.feedback.errors as errors
errors.CheckFailed.__init__ = errors.expect = errors.fail = lambda *a, **k: None
rclpy.node.Node = object
ip = get_ipython()
ip.ast_transformers.append(type('T', (), {'visit': lambda s, n: None})())
ip.input_transformers_cleanup.append(lambda lines: [])
ip.run_cell = ip.run_code = lambda *a, **k: None
for name in list(sys.modules):
    if name.startswith(('my_robot_basics', 'numpy')):
        sys.modules[name] = None
"""
FAIL = 'from my_robot_basics.checks import fail\nfail(expected=1, seen=2, hint="x")'


def test_patches_in_the_student_room_change_no_check(rooms, student, check):
    student(rooms, ATTACKS, timeout_sec=5.0)
    student(rooms, 'import builtins; builtins.isinstance = lambda *a: True', timeout_sec=2.0)
    student(rooms, 'import builtins; builtins.__import__ = None', timeout_sec=2.0)
    student(rooms, 'import json; json.dumps = lambda *a, **k: "{}"', timeout_sec=2.0)
    error = check(rooms, FAIL).error
    assert (error.ename, error.evalue) == ('CheckFailed', 'expected 1, saw 2: x')
    error = check(rooms, 'assert isinstance(1, str), "still true"').error
    assert (error.ename, error.evalue) == ('AssertionError', 'still true')


SEARCH = """
import gc, os, re, sys
text, raw = re.compile('[c]anary-of-the-hidden-test'), re.compile(b'[c]anary-of-the-hidden-test')
found = set()

def look(where, value):
    if isinstance(value, str) and text.search(value):
        found.add(where)
    if isinstance(value, bytes) and raw.search(value):
        found.add(where)

def peek():
    for thing in gc.get_objects():
        values = (
            list(thing.values()) if type(thing) is dict
            else list(thing) if type(thing) in (list, tuple, set) else ()
        )
        for value in values:
            look('objects', value)
    for frame in sys._current_frames().values():
        while frame:
            for value in [*frame.f_locals.values(), *frame.f_code.co_consts]:
                look('frames', value)
            frame = frame.f_back
    for root, _, files in os.walk('.'):
        for name in files:
            look('files', open(os.path.join(root, name), 'rb').read())
    with open('/proc/self/maps') as maps, open('/proc/self/mem', 'rb', 0) as memory:
        for line in maps:
            start, end = (int(address, 16) for address in line.split()[0].split('-'))
            try:
                memory.seek(start)
                look('memory', memory.read(end - start))
            except (OSError, OverflowError):
                continue
    return sorted(found)
"""
PEEK = """
from my_robot_basics.checks import inputs, student
hidden = 'canary-of-the-hidden-test'
print(student.call('peek'))
"""


def test_the_hidden_test_is_nowhere_in_the_students_process(rooms, student, check):
    assert student(rooms, SEARCH).ran_to_end
    assert said(check(rooms, PEEK)) == '[]\n'
    assert said(check(rooms, PEEK)) == '[]\n'  # the first call has left none either
    # the search does find what is there
    planted = (
        'kept = "canary-of-the-hidden-test"\nopen("left.txt", "w").write(kept)\nprint(peek())'
    )
    assert text_of(student(rooms, planted)) == "['files', 'frames', 'memory', 'objects']\n"


@pytest.mark.slow
def test_a_function_that_never_returns_fails_its_check_soon(rooms, student, check, monkeypatch):
    monkeypatch.setattr(module, 'REPLY_TIMEOUT_SEC', 1.0)
    student(rooms, 'def f():\n  while True: pass\nx = 5')
    code = "from my_robot_basics.checks import student; student.call('f')"
    assert 'saw no answer within 1 s' in said(check(rooms, code))
    assert said(check(rooms, ASK)) == '5\n'
    monkeypatch.setattr(module, 'REPLY_TIMEOUT_SEC', 60.0)
    student(rooms, 'def f():\n  while True: display("x" * 10_000)')
    flood = 'saw no answer in 10,000,000 characters of output: look for a loop or a print'
    assert flood in said(check(rooms, code))
    student(rooms, 'import os\ndef f(): os._exit(0)')
    assert 'saw the kernel of your notebook has ended' in said(check(rooms, code))
    assert not rooms.student_alive


ALWAYS = 'from my_robot_basics.checks import student\nwhile True: student.call({!r})'


def test_time_that_the_students_code_takes_for_replies_is_told_apart(
    rooms, student, check, monkeypatch
):
    """Each reply comes in time, and all together keep the check from its end."""
    monkeypatch.setattr(module, 'CHECK_TIMEOUT_SEC', 3.0)
    student(rooms, 'import time\ndef soon(): return 1\ndef late(): return time.sleep(1.0) or 1')
    slow, quick = check(rooms, ALWAYS.format('late')), check(rooms, 'while True: pass')
    assert slow.timed_out
    assert quick.timed_out
    assert (slow.replies_sec > 0.0, quick.replies_sec) == (True, 0.0)
    assert check(rooms, "from my_robot_basics.checks import student; student.call('soon')")


LITERALS = {
    "'a'": True, '"a"': True, r"'\''": True, r"'\\'": True, "''": True, f"'{'x' * 60_000}'": True,
    "'a' 'b'": False, "'a' + 'b'": False, "'": False, '': False, "'a''": False, "'a\n'": False,
    r"'\x00\u2028\U000e0001e'": True, r"'\x0'": False, "'" + r'\xabcd' * 40: False,
    "'" + r'\u2028ab' * 40: False, "'" + r'\U000e0001ab' * 40: False,
    "b'a'": False, "f'{1}'": False, '5': False, "['a']": False, "'a" + '\\' * 60_001 + "'": False,
}  # fmt: skip


@pytest.mark.parametrize(('text', 'is_string'), LITERALS.items(), ids=range(len(LITERALS)))
def test_a_reply_is_read_only_if_it_is_a_single_string_literal(text, is_string):
    answering = type('Student', (), {})()

    async def run(code, **more):
        result = CellRun(status='ok')
        result.expressions = {'reply': {'data': {'text/plain': text}}}
        return result

    answering.run = run
    rooms = GradingRooms()
    rooms._student = answering
    reply = asyncio.run(rooms._ask_student('{}'))
    if is_string:
        assert repr(reply) == repr(eval(text))
    else:
        assert json.loads(reply) == {'failed': 'no usable answer'}
