"""Kernels that end while they are graded: who is responsible, and which verdict follows."""

import asyncio
import contextlib
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from doubling_lesson import GOOD, handed_in, lesson
from my_robot_basics.validate.verdicts import budget

from grader.judging import execute as module
from grader.judging.execute import execute
from grader.kernels import fork_servers
from grader.kernels.kernel_exits import Ending, Responsibility
from grader.kernels.rooms import GradingRooms
from grader.sandbox import cgroups
from grader.sandbox.cgroup_hierarchies import NoCgroups, hierarchies
from grader.sandbox.cgroups import MemoryEvents, remove_cgroup
from grader.sandbox.limits import PROCESS_LIMITS, ROOM_MEMORY_BYTES

pytestmark = pytest.mark.isolation

ASKS = """
import time
from my_robot_basics.checks import expect, student
for _ in range(20):
    expect(student.call('double', 2) == 4, expected=4, seen='less', hint='twice')
    time.sleep(0.1)
"""
LISTENS = """
import time
from my_robot_basics.checks import expect, student
time.sleep(1.5)
expect(student.call('double', 2) == 4, expected=4, seen='less', hint='twice')
"""
NODE = (
    GOOD
    + """
import subprocess
node = subprocess.Popen(['sleep', '60'])
"""
)
NEEDS_NODE = """
import time
from my_robot_basics.checks import expect, student
time.sleep(1.0)
seen = student.call('double_status')
expect(seen == 'running', expected='a node', seen=seen, hint='keep it')
"""
STATUS = """
def double_status():
    state = open(f'/proc/{node.pid}/stat').read().split()[2]
    return 'running' if state in 'RS' else 'ended'
"""
MEBIBYTE = 2**20


@pytest.fixture(params=['forked', 'started'])
def way(request, monkeypatch):
    """Kernels are forked, or they are started."""
    if request.param == 'started':
        for room in ('student', 'test'):
            monkeypatch.setitem(fork_servers._unfit, room, 'the test says so')
    return request.param


def strike(monkeypatch, hit, *, when, delay_sec=0.5, times=2):
    """Let `hit` do something to a student's kernel, from outside, while something runs."""
    opened = []

    class Struck(GradingRooms):
        async def run_student_cell(self, source, *, timeout_sec):
            return await self._struck(
                'cell' if 'time.sleep' in source else '',
                super().run_student_cell(source, timeout_sec=timeout_sec),
            )

        async def run_check(self, source):
            return await self._struck('check', super().run_check(source))

        async def _struck(self, what, work):
            if what == when and len(opened) < times:
                opened.append(self)
                loop = asyncio.get_running_loop()
                pid = self._student._manager.provisioner.signals.pid
                loop.call_later(delay_sec, hit, psutil.Process(pid))
            return await work

    monkeypatch.setattr(module, 'GradingRooms', Struck)
    return opened


def graded(check, answer=GOOD):
    execution = execute(handed_in(lesson('a', check=check), a=answer))
    return execution.verdicts[0]


def kill(process):
    process.kill()


def terminate(process):
    process.terminate()


def kill_the_room(process):
    """End the first process of its PID namespace, as ending bubblewrap does."""
    space = os.readlink(f'/proc/{process.pid}/ns/pid')
    for other in psutil.process_iter():
        with contextlib.suppress(OSError):
            inside = os.readlink(f'/proc/{other.pid}/ns/pid') == space
            status = Path(f'/proc/{other.pid}/status').read_text()
            if inside and re.search(r'^NSpid:.*\t1$', status, re.MULTILINE):
                other.kill()
                return
    raise AssertionError('the room has no first process')


SLOW = f'import time; time.sleep(1.5)\n{GOOD}'
MOMENTS = {
    'in a cell': ('cell', ASKS, SLOW, 0.5),
    'as a check begins': ('check', ASKS, GOOD, 0.0),
    'between the questions of a check': ('check', ASKS, GOOD, 1.0),
    'while a check listens': ('check', LISTENS, GOOD, 0.7),
}


CRASHES = 'import ctypes; ctypes.string_at(0)'
"""Stands for data that make Fast DDS crash, which student code may send."""


def test_a_check_whose_own_kernel_crashes_is_left_to_a_person_who_learns_how(way):
    verdict = graded(CRASHES)
    assert (verdict.outcome, verdict.score) == ('ungraded', None)
    assert verdict.reason.endswith('the test kernel crashed with SIGSEGV')


@pytest.mark.parametrize('hit', [kill, terminate, kill_the_room])
@pytest.mark.parametrize(('when', 'check', 'answer', 'delay_sec'), MOMENTS.values(), ids=MOMENTS)
def test_a_kernel_ended_from_outside_is_ungraded_and_not_zero(
    monkeypatch, way, hit, when, check, answer, delay_sec
):
    struck = strike(monkeypatch, hit, when=when, delay_sec=delay_sec)
    verdict = graded(check, answer)
    assert (verdict.outcome, len(struck)) == ('ungraded', 2)
    assert 'a person has to look at it' in verdict.reason


@pytest.mark.slow
@pytest.mark.parametrize(('when', 'check', 'answer', 'delay_sec'), MOMENTS.values(), ids=MOMENTS)
def test_a_kernel_ended_once_from_outside_is_graded_in_fresh_rooms(
    monkeypatch, when, check, answer, delay_sec
):
    struck = strike(monkeypatch, kill, when=when, delay_sec=delay_sec, times=1)
    assert graded(check, answer).outcome == 'passed'
    assert len(struck) == 1


OWN_DOING = {
    'exit': ('exit()', 'it calls exit()'),
    'os._exit': ('import os; os._exit(0)', ''),
    'a code that looks like a signal': ('import os; os._exit(137)', ''),
    'SIGKILL': ('import os; os.kill(os.getpid(), 9)', 'your code sent it SIGKILL'),
    'SIGTERM': ('import os; os.kill(os.getpid(), 15)', 'your code sent it SIGTERM'),
    'its group': ('import os; os.kill(0, 9)', 'your code sent it SIGKILL'),
    'a program': (
        'import subprocess; subprocess.run(["sh", "-c", "kill -9 $PPID"])',
        'your code sent it SIGKILL',
    ),
    'a pidfd': (
        'import os, signal; signal.pidfd_send_signal(os.pidfd_open(os.getpid()), 9)',
        'your code sent it SIGKILL',
    ),
    'a system call': (
        'import ctypes, os; ctypes.CDLL(None).syscall(62, os.getpid(), 9)',
        'your code sent it SIGKILL',
    ),
    'a signal for its own input': (
        'import fcntl, os, signal\n'
        'r, w = os.pipe()\n'
        'fcntl.fcntl(r, fcntl.F_SETFL, os.O_ASYNC)\n'
        'fcntl.fcntl(r, fcntl.F_SETOWN, os.getpid())\n'
        'fcntl.fcntl(r, 10, signal.SIGKILL)\n'
        'os.write(w, b"x")',
        'your code sent it SIGKILL',
    ),
    'the end of a child': (
        'import ctypes, os\n'
        'if ctypes.CDLL(None).syscall(56, 9, 0, 0, 0, 0) == 0: os._exit(0)\n'
        'import time; time.sleep(8)',
        'your code sent it SIGKILL',
    ),
    'less processor time': (
        'import resource\n'
        'resource.setrlimit(resource.RLIMIT_CPU, (1, 1))\n'
        'while True: pass',
        'your code sent it SIGKILL',
    ),
    'a crash': ('import ctypes; ctypes.string_at(0)', 'it crashed with SIGSEGV'),
    'abort': ('import os; os.abort()', 'your code sent it SIGABRT'),
    'an alarm': ('import signal, time; signal.alarm(1); time.sleep(5)', 'SIGALRM ended it'),
    'a timer of its processor time': (
        'import signal\nsignal.setitimer(signal.ITIMER_PROF, 0.2)\nwhile True: pass',
        'SIGPROF ended it',
    ),
    'a pipe that nobody reads': (
        'import os, signal\n'
        'signal.signal(signal.SIGPIPE, signal.SIG_DFL)\n'
        'r, w = os.pipe()\n'
        'os.close(r)\n'
        'os.write(w, b"x")',
        'SIGPIPE ended it',
    ),
    'a socket that tells its group': (
        'import fcntl, os, socket, struct\n'
        'a, b = socket.socketpair()\n'
        'fcntl.ioctl(a, 0x8902, struct.pack("i", os.getpid()))\n'
        'fcntl.fcntl(a, fcntl.F_SETFL, os.O_ASYNC)\n'
        'b.send(b"x")\n'
        'import time; time.sleep(2)',
        'SIGIO ended it',
    ),
}  # fmt: skip


@pytest.mark.parametrize(('answer', 'why'), OWN_DOING.values(), ids=OWN_DOING)
def test_an_answer_that_ends_its_own_kernel_fails_with_the_reason(way, answer, why):
    verdict = graded(ASKS, answer)
    assert verdict.outcome == 'failed'
    assert f'your cell `a` ended the kernel{": " + why if why else ""}' in verdict.reason


@pytest.mark.slow
@pytest.mark.parametrize('number', [9, 15])
def test_an_answer_that_ends_its_kernel_during_a_check_fails(way, number):
    later = f'import os, threading; threading.Timer(1.0, os.kill, (os.getpid(), {number})).start()'
    assert graded(ASKS, f'{GOOD}\n{later}').outcome == 'failed'


def answer_with_node(more=''):
    return NODE + more + STATUS


def kill_a_child(process):
    [child] = process.children()
    child.kill()


@pytest.mark.slow
def test_a_node_ended_from_outside_is_ungraded_and_not_zero(monkeypatch, way):
    struck = strike(monkeypatch, kill_a_child, when='check', delay_sec=0.3)
    verdict = graded(NEEDS_NODE, answer_with_node())
    assert (verdict.outcome, len(struck)) == ('ungraded', 2)
    assert 'SIGKILL ended it' in verdict.reason


@pytest.mark.slow
@pytest.mark.parametrize('times', [1, 0])
def test_a_node_that_survives_the_second_attempt_passes(monkeypatch, times):
    struck = strike(monkeypatch, kill_a_child, when='check', delay_sec=0.3, times=times)
    verdict = graded(NEEDS_NODE, answer_with_node())
    assert (verdict.outcome, len(struck)) == ('passed', times)


WITH_ITS_PARENT = """
import ctypes, threading
def start():
    global node
    die_with_me = lambda: ctypes.CDLL(None).prctl(1, 9)
    node = subprocess.Popen(['sleep', '60'], preexec_fn=die_with_me)
node.kill()
node.wait()
thread = threading.Thread(target=start)
thread.start()
thread.join()
"""
BY_ITS_TERMINAL = """
import os, pty
node.kill()
node.wait()
pid, terminal = pty.fork()
if pid == 0:
    os.execvp('sleep', ['sleep', '60'])
node.pid = pid
os.close(terminal)
"""


@pytest.mark.parametrize(
    'own',
    [
        'node.kill()',
        'node.terminate()',
        'import os; os.kill(node.pid, 9)',
        'subprocess.run(["sh", "-c", f"kill -9 {node.pid}"])',
        WITH_ITS_PARENT,
        BY_ITS_TERMINAL,
    ],
)
def test_an_answer_that_ends_its_own_node_fails(way, own):
    assert graded(NEEDS_NODE, answer_with_node(f'{own}\n')).outcome == 'failed'


def needs_cgroups():
    try:
        return hierarchies()
    except NoCgroups as problem:
        pytest.skip(f'no cgroup can be had here: {problem}')


PIECES = ROOM_MEMORY_BYTES // (64 * MEBIBYTE)
HOG = f'hog = [bytearray(b"x" * {64 * MEBIBYTE}) for _ in range({PIECES})]'


@pytest.fixture
def in_any_time(monkeypatch):
    """Let a cell fill its memory for as long as that takes: on a busy machine, over a minute."""
    monkeypatch.setattr(budget, 'STUDENT_CELL_TIMEOUT_SEC', 500.0)
    monkeypatch.setattr(module, 'Budget', lambda: budget.Budget(500.0))


@pytest.mark.slow
@pytest.mark.usefixtures('in_any_time')
def test_an_answer_that_uses_too_much_memory_twice_fails_with_the_reason(way):
    needs_cgroups()
    verdict = graded(ASKS, f'{GOOD}\n{HOG}')
    assert verdict.outcome == 'failed'
    assert 'your code used more than 2,048 MB' in verdict.reason


@pytest.mark.slow
@pytest.mark.usefixtures('in_any_time')
def test_an_answer_whose_program_uses_too_much_memory_fails_with_a_note():
    needs_cgroups()
    hog = f'import subprocess, sys; node = subprocess.Popen([sys.executable, "-c", {HOG!r}])'
    more = '\nnode.wait()\n'
    verdict = graded(NEEDS_NODE, f'{GOOD}\n{hog}{more}{STATUS}')
    assert verdict.outcome == 'failed'
    assert verdict.notes == ('what you started has ended: your code used more than 2,048 MB',)


@pytest.mark.slow
def test_a_machine_out_of_memory_leaves_the_answer_ungraded(monkeypatch):
    """A real OOM: a neighbour eats what both may have, and Linux ends the student's kernel."""
    where = needs_cgroups()
    outer = where.folders['memory'] / f'mrb-outer-{os.getpid()}'
    outer.mkdir()
    begun = []
    try:
        name = 'memory.limit_in_bytes' if where.version == 1 else 'memory.max'
        if where.version == 2:
            (outer / 'cgroup.subtree_control').write_text('+memory +pids')
        inside = cgroups.Hierarchies(where.version, where.folders | {'memory': outer})
        if where.version == 2:
            inside = cgroups.Hierarchies(2, dict.fromkeys(where.folders, outer))
        monkeypatch.setattr(cgroups, 'hierarchies', lambda: inside)
        (outer / name).write_text(str(700 * MEBIBYTE))
        neighbour = outer / 'neighbour'
        neighbour.mkdir()

        def eat(_):
            code = f'import time; hog = b"x" * {900 * MEBIBYTE}; time.sleep(60)'
            join = f'echo 0 >{neighbour}/cgroup.procs && exec "$@"'
            begun.append(subprocess.Popen(['sh', '-c', join, 'sh', sys.executable, '-c', code]))

        strike(monkeypatch, eat, when='check', delay_sec=0.2)
        verdict = graded(ASKS.replace('range(20)', 'range(300)'))
        assert verdict.outcome == 'ungraded'
        assert 'the machine ran out of memory' in verdict.reason
    finally:
        for process in begun:
            process.kill()
            process.wait()
        deadline = time.monotonic() + 10
        while not remove_cgroup(outer) and time.monotonic() < deadline:
            time.sleep(0.05)


NO_MEMORY_LOST = MemoryEvents()
ENDINGS = [
    (Ending(0), NO_MEMORY_LOST, Responsibility.STUDENTS),
    (Ending(9, sent=True), NO_MEMORY_LOST, Responsibility.STUDENTS),
    (Ending(9), NO_MEMORY_LOST, Responsibility.NOT_SHOWN),
    (Ending(15), NO_MEMORY_LOST, Responsibility.NOT_SHOWN),
    (Ending(64), NO_MEMORY_LOST, Responsibility.NOT_SHOWN),
    (Ending(None), NO_MEMORY_LOST, Responsibility.NOT_SHOWN),
    (Ending(11), NO_MEMORY_LOST, Responsibility.DOUBTFUL),
    (Ending(31), NO_MEMORY_LOST, Responsibility.DOUBTFUL),
    (Ending(9), MemoryEvents(limit_reached=True, killed=1), Responsibility.DOUBTFUL),
    (Ending(9), MemoryEvents(limit_reached=False, killed=1), Responsibility.NOT_SHOWN),
    (Ending(9), MemoryEvents(limit_reached=True, killed=0), Responsibility.NOT_SHOWN),
    (Ending(15), MemoryEvents(limit_reached=True, killed=1), Responsibility.NOT_SHOWN),
]


@pytest.mark.parametrize(('ending', 'memory', 'responsibility'), ENDINGS)
def test_students_are_responsible_only_for_endings_shown_as_theirs(ending, memory, responsibility):
    assert ending.responsibility(memory)[0] is responsibility


def test_students_are_responsible_for_too_much_processor_time():
    ending = Ending(9, cpu_sec=max(PROCESS_LIMITS.values()))
    assert ending.responsibility(NO_MEMORY_LOST)[0] is Responsibility.STUDENTS
