"""Two rooms: only JSON text and DDS cross from one to the other."""

import asyncio
from types import SimpleNamespace

import pytest
from my_robot_basics.validate.kernels.outputs import CellRun
from two_rooms import PUBLISH, check_in, opened_rooms, said, student_in, text_of

from grader.kernels.rooms import GradingRooms


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
    with opened_rooms(loop, extra_files=sorted(folder.glob('*.py'))) as rooms:
        yield rooms


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


def test_a_student_room_starts_with_the_names_of_ipython_alone(shared, student):
    seen = student(shared, 'print(sorted(n for n in globals() if not n.startswith("_")))')
    assert text_of(seen) == "['In', 'Out', 'exit', 'get_ipython', 'open', 'quit']\n"


@pytest.mark.slow
def test_cpu_time_of_child_processes_that_nobody_waits_for_is_counted(rooms, student):
    before_sec = rooms.student_cpu_sec()
    assert (before_sec is None) is (
        rooms._sandbox is None or rooms._sandbox.cgroup('student') is None
    )
    if before_sec is None:
        pytest.skip('this machine gives us no cgroups')
    # nobody waits for these children: their CPU times are added to no parent's
    student(rooms, BURN)
    assert rooms.student_cpu_sec() - before_sec >= 0.5


def test_timeouts_of_cells_and_questions_use_the_cpu_time_of_the_student_room(monkeypatch):
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


def test_a_cell_that_imports_live_finds_the_kernel_set_up(rooms, student):
    code = 'from my_robot_basics.live.nodes import runner; print(runner._is_set_up)'
    assert said(student(rooms, code)) == 'True\n'


def test_submitted_modules_can_be_imported_and_shadow_nothing(shared, student):
    code = 'import helper, numpy, json, rclpy, my_robot_basics.live; print(helper.WHERE)'
    result = student(shared, code)
    assert said(result) == 'my own helper\n'


def test_submitted_modules_cannot_be_imported_before_the_rooms_are_ready(loop, student, tmp_path):
    """Libraries try to import some optional modules: submitted ones would end the kernel."""
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
    # the hash seed of Python is the same in each room, and no secret
    assert text_of(student(shared, code)) == "['PYTHONHASHSEED']\n"
    assert text_of(check(shared, code)) == "['MY_ROBOT_BASICS_SEED', 'PYTHONHASHSEED']\n"


def test_a_check_reads_student_values_and_calls_student_functions_by_name(shared, student, check):
    student(shared, 'x = {"a": (1, 2.5)}\ndef f(a, b=2): return [a, b]')
    code = IMPORT + "print(student.value('x'), student.call('f', 7))"
    assert said(check(shared, code)) == "{'a': (1, 2.5)} [7, 2]\n"


def test_any_text_passes_unchanged_between_the_rooms(shared, student, check):
    text = '\'"\\\n\x00θ🐢{}%s' + '\\' * 50
    student(shared, f'def same(x): return x + {text!r}')
    code = f"{IMPORT}print(student.call('same', {text!r}) == {text * 2!r})"
    assert said(check(shared, code)) == 'True\n'


def test_prints_of_a_called_student_function_do_not_reach_the_check(shared, student, check):
    student(shared, "def f():\n  import sys; print('x'); print('y', file=sys.stderr); return 1")
    result = check(shared, "from my_robot_basics.checks import student; print(student.call('f'))")
    assert [(o.name, o.text) for o in result.outputs] == [('stdout', '1\n')]


def test_the_test_room_does_not_load_student_code(shared, student, check):
    student(shared, 'import helper; helper.X = 1; mine = 5')
    code = "import sys; print({'helper', 'mine'} & {*sys.modules, *globals()}, *sys.path)"
    seen = said(check(shared, code))
    assert seen.startswith('set() ')
    assert 'given' not in seen


RECEIVE = """
from my_robot_basics.checks import topic
print(topic('/said').wait_for(timeout_sec=20.0).data)
"""


def test_a_students_topic_reaches_its_own_test_room_and_no_other(rooms, shared, student, check):
    student(rooms, PUBLISH)
    assert said(check(rooms, RECEIVE)) == 'hello\n'
    code = 'from my_robot_basics.checks import graph; print(graph().nodes())'
    assert 'talker' in said(check(rooms, code))
    assert 'talker' not in said(check(shared, code))


IN_SHARED_MEMORY = PUBLISH.replace(
    'rclpy.init()',
    'import os; os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"\nrclpy.init()',
)


@pytest.mark.isolation
def test_a_publisher_that_prefers_shared_memory_reaches_the_test_room(rooms, student, check):
    student(rooms, IN_SHARED_MEMORY)
    assert said(check(rooms, RECEIVE)) == 'hello\n'


def test_the_probe_receives_a_message_only_while_one_is_announced(loop):
    from my_robot_basics.exchange import probe

    with pytest.raises(TimeoutError, match='no message went from kernel to kernel in 0 s'):
        probe.receive(0.3)
    probe.announce()
    try:
        probe.receive()
    finally:
        probe.remove_announcement()
    with pytest.raises(TimeoutError):
        probe.receive(0.3)
