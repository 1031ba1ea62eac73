"""Two rooms: only JSON text and DDS cross from one to the other."""

import asyncio
import json
import shutil
import tempfile
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from my_robot_basics.session import domain
from my_robot_basics.session.errors import NoFreeDomain
from my_robot_basics.validate.outputs import CellRun

from grader.common.errors import RoomFailure
from grader.kernels import rooms as module
from grader.kernels.isolation import require_isolation
from grader.kernels.rooms import GradingRooms

IMPORT = 'from my_robot_basics.checks import student\n'
BURN = """
import os, signal, time
signal.signal(signal.SIGCHLD, signal.SIG_IGN)
for _ in range(5):
    if os.fork() == 0:
        while time.process_time() < 0.2:
            pass
        os._exit(0)
try:
    os.wait()
except ChildProcessError:
    pass
"""


@pytest.fixture(scope='module')
def shared(loop, tmp_path_factory):
    """Rooms whose student handed in files that would like to shadow others."""
    folder = tmp_path_factory.mktemp('handed_in')
    for name in (
        'numpy',
        'json',
        'rclpy',
        'ipykernel_launcher',
        'sitecustomize',
        'my_robot_basics',
    ):
        (folder / f'{name}.py').write_text('raise SystemExit("shadowed")')
    (folder / 'helper.py').write_text('WHERE = "my own helper"')
    rooms = GradingRooms(
        extra_files=sorted(folder.glob('*.py')), seed='beef', isolated=require_isolation()
    )
    loop.run(rooms.__aenter__())
    yield rooms
    loop.run(rooms.__aexit__())


@pytest.fixture
def rooms(loop):
    """Rooms of one test's own."""
    rooms = GradingRooms(seed='beef', isolated=require_isolation())
    loop.run(rooms.__aenter__())
    yield rooms
    loop.run(rooms.__aexit__())


@pytest.fixture
def student(loop):
    def run(rooms, code, timeout_sec=60.0):
        return loop.run(rooms.run_student_cell(code, timeout_sec=timeout_sec))

    return run


@pytest.fixture
def check(loop):
    return lambda rooms, code: loop.run(rooms.run_check(code))


def text_of(cell_run):
    return ''.join(o.get('text', '') for o in cell_run.outputs)


def said(cell_run):
    """Return what a check printed, or its error."""
    return cell_run.error.evalue if cell_run.error else text_of(cell_run)


def test_the_names_of_a_notebook_are_the_students_alone(shared, student):
    seen = student(shared, 'print(sorted(n for n in globals() if not n.startswith("_")))')
    assert text_of(seen) == "['In', 'Out', 'exit', 'get_ipython', 'open', 'quit']\n"


@pytest.mark.slow
def test_all_time_that_a_students_room_takes_is_counted_however_it_is_taken(rooms, student):
    before_sec = rooms.student_cpu_sec()
    assert (before_sec is None) is (
        rooms._sandbox is None or rooms._sandbox.cgroup('student') is None
    )
    if before_sec is None:
        pytest.skip('this machine gives us no cgroups')
    # nobody waits for these: their times are no parent's
    student(rooms, BURN)
    assert rooms.student_cpu_sec() - before_sec >= 0.5


def test_cells_and_questions_are_waited_for_by_what_the_students_room_has_used(monkeypatch):
    waited = []

    async def run(source, *, timeout_sec, used_sec, expressions=None):
        waited.append(used_sec())
        return CellRun()

    rooms = GradingRooms()
    monkeypatch.setattr(rooms, '_student', SimpleNamespace(run=run), raising=False)
    monkeypatch.setattr(rooms, 'student_cpu_sec', lambda: 5.0)
    asyncio.run(rooms.run_student_cell('1', timeout_sec=10.0))
    asyncio.run(rooms._ask_student('{}'))
    assert waited == [5.0, 5.0]


def test_a_cell_that_names_live_finds_the_kernel_set_up(rooms, student):
    code = 'from my_robot_basics.live import runner; print(runner._is_set_up)'
    assert said(student(rooms, code)) == 'True\n'


def test_own_modules_can_be_imported_and_shadow_nothing(shared, student):
    code = 'import helper, numpy, json, rclpy, my_robot_basics.live; print(helper.WHERE)'
    result = student(shared, code)
    assert said(result) == 'my own helper\n'


def test_own_modules_are_not_there_before_the_probe(loop, student, tmp_path):
    """Some that libraries look for, and do without: they would end the kernel."""
    for name in ('regex', 'atomicwrites', 'future_builtins', 'nothing_else'):
        (tmp_path / f'{name}.py').write_text('import os; os._exit(0)')
    rooms = GradingRooms(extra_files=sorted(tmp_path.glob('*.py')), isolated=False)
    loop.run(rooms.__aenter__())
    assert said(student(rooms, 'print(1)')) == '1\n'
    assert student(rooms, 'import nothing_else').died
    loop.run(rooms.__aexit__())


def test_the_student_room_holds_no_seed(shared, student, check):
    code = (
        "import os; print(sorted(k for k, v in os.environ.items() if 'beef' in v or 'SEED' in k))"
    )
    # that of sets is the same in each room, and no secret
    assert text_of(student(shared, code)) == "['PYTHONHASHSEED']\n"
    assert text_of(check(shared, code)) == "['MY_ROBOT_BASICS_SEED', 'PYTHONHASHSEED']\n"


def test_values_and_functions_cross_by_name(shared, student, check):
    student(shared, 'x = {"a": (1, 2.5)}\ndef f(a, b=2): return [a, b]')
    code = IMPORT + "print(student.value('x'), student.call('f', 7))"
    assert said(check(shared, code)) == "{'a': (1, 2.5)} [7, 2]\n"


def test_text_crosses_as_it_is(shared, student, check):
    text = '\'"\\\n\x00θ🐢{}%s' + '\\' * 50
    student(shared, f'def same(x): return x + {text!r}')
    code = f"{IMPORT}print(student.call('same', {text!r}) == {text * 2!r})"
    assert said(check(shared, code)) == 'True\n'


def test_what_a_called_function_prints_reaches_no_check(shared, student, check):
    student(shared, "def f():\n  import sys; print('x'); print('y', file=sys.stderr); return 1")
    result = check(shared, "from my_robot_basics.checks import student; print(student.call('f'))")
    assert [(o.name, o.text) for o in result.outputs] == [('stdout', '1\n')]


def test_the_test_room_does_not_load_student_code(shared, student, check):
    student(shared, 'import helper; helper.X = 1; mine = 5')
    code = "import sys; print({'helper', 'mine'} & {*sys.modules, *globals()}, *sys.path)"
    seen = said(check(shared, code))
    assert seen.startswith('set() ')
    assert 'given' not in seen


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


def test_a_hostile_reply_is_a_failed_check_and_no_more(rooms, student, check):
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


def test_what_a_student_patches_changes_no_check(rooms, student, check):
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


def test_the_hidden_test_is_nowhere_in_the_students_process(shared, student, check):
    assert student(shared, SEARCH).ran_to_end
    assert said(check(shared, PEEK)) == '[]\n'
    assert said(check(shared, PEEK)) == '[]\n'  # nor is the first one left there
    # the search does find what is there
    planted = (
        'kept = "canary-of-the-hidden-test"\nopen("left.txt", "w").write(kept)\nprint(peek())'
    )
    assert text_of(student(shared, planted)) == "['files', 'frames', 'memory', 'objects']\n"


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


PUBLISH = """
import threading, time, rclpy
from std_msgs.msg import String
rclpy.init()
node = rclpy.create_node('talker')
publisher = node.create_publisher(String, '/said', 10)
node.create_timer(0.05, lambda: publisher.publish(String(data='hello')))
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
"""
RECEIVE = """
from my_robot_basics.checks import topic
print(topic('/said').wait_for(timeout_sec=20.0).data)
"""


def test_a_topic_crosses_but_not_into_the_rooms_next_door(rooms, shared, student, check):
    student(rooms, PUBLISH)
    assert said(check(rooms, RECEIVE)) == 'hello\n'
    code = 'from my_robot_basics.checks import graph; print(graph().nodes())'
    assert 'talker' in said(check(rooms, code))
    assert 'talker' not in said(check(shared, code))


@pytest.fixture
def left(monkeypatch):
    """What rooms that a test opened have left: children, files, domains."""
    folder = Path(tempfile.mkdtemp(prefix='left-', dir='/tmp'))
    monkeypatch.setattr(tempfile, 'tempdir', str(folder))
    before = {p.pid for p in psutil.Process().children(recursive=True)}
    claims = {id(c) for c in domain._held if c.fileno() >= 0}

    def left():
        children = {p.pid for p in psutil.Process().children(recursive=True)} - before
        taken = {id(c) for c in domain._held if c.fileno() >= 0} - claims
        return len(children), len(list(folder.glob('*/*'))), len(taken)

    yield left
    shutil.rmtree(folder)


NOTHING = (0, 0, 0)


FAILURES = {
    'no domain is free': ('claim', NoFreeDomain('all 101'), 'could not be opened: all 101'),
    'the disk is full': ('mkdtemp', OSError(28, 'No space left'), 'could not be opened: .*space'),
    'a file vanished': ('copyfile', FileNotFoundError(2, 'gone'), 'could not be opened: .*gone'),
}  # fmt: skip


@pytest.mark.parametrize(('what', 'error', 'why'), FAILURES.values(), ids=FAILURES)
def test_rooms_that_do_not_open_are_the_graders_failure(
    loop, monkeypatch, tmp_path, left, what, error, why
):
    def fail(*arguments, **options):
        raise error

    places = {'claim': module, 'mkdtemp': tempfile, 'copyfile': shutil}
    (tmp_path / 'a.py').write_text('')
    monkeypatch.setattr(places[what], what, fail)
    with pytest.raises(RoomFailure, match=why):
        loop.run(
            GradingRooms(
                extra_files=[tmp_path / 'a.py'], isolated=require_isolation()
            ).__aenter__()
        )
    assert left() == NOTHING


PROBE = 'import sys; from my_robot_basics.exchange import probe'
NOT_READY = {
    'a room that cannot be prepared': ('import nothing', 'student room .* No module named'),
    'a probe that nobody receives': (PROBE, 'test room .* no message went from'),
    'a student room that dies': ('import os; os._exit(1)', 'student room could not be made ready'),
}  # fmt: skip


@pytest.mark.timeout(60)
@pytest.mark.parametrize(('code', 'why'), NOT_READY.values(), ids=NOT_READY)
def test_a_room_that_is_not_made_ready_closes_both(loop, monkeypatch, left, code, why):
    monkeypatch.setattr(module, 'STUDENT_COMES', code)
    timeout_sec = 0.5 if code == PROBE else 3600  # what can't come any more is not waited for
    receives = module.TEST_RECEIVES.replace('receive()', f'receive({timeout_sec})')
    monkeypatch.setattr(module, 'TEST_RECEIVES', receives)
    monkeypatch.setattr(module, 'SETUP_TIMEOUT_SEC', 3600.0)
    with pytest.raises(RoomFailure, match=why):
        loop.run(GradingRooms(isolated=require_isolation()).__aenter__())
    assert left() == NOTHING


IN_SHARED_MEMORY = PUBLISH.replace(
    'rclpy.init()',
    'import os; os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"\nrclpy.init()',
)


@pytest.mark.isolation
def test_a_student_who_prefers_shared_memory_is_heard_too(rooms, student, check):
    student(rooms, IN_SHARED_MEMORY)
    assert said(check(rooms, RECEIVE)) == 'hello\n'


def test_cancelling_while_rooms_open_closes_them(loop, left):
    async def cancelled():
        task = asyncio.ensure_future(GradingRooms(isolated=require_isolation()).__aenter__())
        while left()[0] < 2:
            await asyncio.sleep(0.05)
        task.cancel()
        await task

    with pytest.raises(asyncio.CancelledError):
        loop.run(cancelled())
    assert left() == NOTHING


@pytest.mark.parametrize('closed', [pytest.param(True, marks=pytest.mark.isolation), False])
def test_rooms_leave_nothing(loop, left, closed):
    rooms = GradingRooms(isolated=closed)

    async def once():
        async with rooms:
            await rooms.run_student_cell(PUBLISH, timeout_sec=60.0)
            return left()

    # a sandbox takes a few processes of its own, and a note of its cgroups where it has some
    seen = loop.run(once())
    noted = closed and rooms._sandbox.cgroup('student') is not None
    assert seen == ((7, 2 + noted, 1) if closed else (2, 2, 1))
    assert left() == NOTHING


LITERALS = {
    "'a'": True, '"a"': True, r"'\''": True, r"'\\'": True, "''": True, f"'{'x' * 60_000}'": True,
    "'a' 'b'": False, "'a' + 'b'": False, "'": False, '': False, "'a''": False, "'a\n'": False,
    r"'\x00\u2028\U000e0001e'": True, r"'\x0'": False, "'" + r'\xabcd' * 40: False,
    "'" + r'\u2028ab' * 40: False, "'" + r'\U000e0001ab' * 40: False,
    "b'a'": False, "f'{1}'": False, '5': False, "['a']": False, "'a" + '\\' * 60_001 + "'": False,
}  # fmt: skip


@pytest.mark.parametrize(('text', 'is_string'), LITERALS.items(), ids=range(len(LITERALS)))
def test_only_the_literal_of_one_string_is_read(text, is_string):
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


def test_the_probe_hears_only_what_is_announced(loop):
    from my_robot_basics.exchange import probe

    with pytest.raises(TimeoutError, match='no message went from kernel to kernel in 0 s'):
        probe.receive(0.3)
    probe.announce()
    try:
        probe.receive()
    finally:
        probe.silence()
    with pytest.raises(TimeoutError):
        probe.receive(0.3)
