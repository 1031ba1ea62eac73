"""The process that forks kernels: what it contains, how long it runs, and when there is none."""

import asyncio
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest
from forked_kernels import (
    DOMAIN,
    SLOTS,
    closed,
    kernel_of,
    opened,
    printed,
    process_of,
    server_of,
)

from grader.course import ROOT
from grader.kernels import fork_servers
from grader.kernels.kernels import GradingKernel
from grader.sandbox import bubblewrap
from grader.sandbox.sandbox import Sandbox

pytestmark = pytest.mark.isolation


@pytest.fixture
def forked(loop):
    yield from kernel_of(loop)


@pytest.fixture
def no_servers():
    """No fork server runs before the test, and none after it."""
    fork_servers.close_servers()
    fork_servers._unfit.clear()
    yield
    fork_servers.close_servers()
    fork_servers._unfit.clear()


def test_a_fork_server_has_no_files_or_variables_of_the_grader(forked):
    server = server_of(forked)
    assert server.num_threads() == 1
    held = [
        os.readlink(f'/proc/{server.pid}/fd/{fd}') for fd in os.listdir(f'/proc/{server.pid}/fd')
    ]
    assert {re.sub(r'\d+', '', link) for link in held} <= {'/dev/null', 'socket:[]'}
    assert len(held) <= 4  # three of them are the standard ones
    assert server.cwd() == '/'
    assert set(server.environ()) <= {
        *bubblewrap.ENVIRONMENT,
        *('MPLBACKEND', 'PYTHONSAFEPATH', 'PYTHONDONTWRITEBYTECODE', 'PYTHONHASHSEED'),
        'LD_LIBRARY_PATH',
        *('_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'LANG', 'LC_ALL', 'TZ'),
    }
    maps = Path(f'/proc/{server.pid}/maps').read_text().splitlines()
    shared = [line for line in maps if line.split()[1].endswith('s')]
    assert [line for line in shared if '/dev/shm' in line or 'w' in line.split()[1]] == []


@pytest.mark.parametrize(('room', 'package'), [('student', 'live'), ('test', 'checks')])
def test_a_fork_server_has_imported_all_modules_that_a_kernel_needs(loop, room, package):
    sandbox, kernel = loop.run(opened(room=room))
    try:
        code = f'from my_robot_basics import {package} as package\nimport json, sys\n'
        code += 'for name in package.__all__:\n    getattr(package, name)\n'
        imported = json.loads(printed(loop, kernel, code + 'print(json.dumps([*sys.modules]))'))
    finally:
        loop.run(closed(sandbox, kernel))
    assert set(imported) <= _held_by_a_server(room)


MORE = """

def import_for(room, usual=import_for):
    usual(room)
    import sys
    sys.path.append({folder!r})
    import imported_by_a_server
    sys.path.remove({folder!r})
"""
"""What makes a server import one more module."""


def test_a_fork_server_writes_bytecode_and_its_kernels_do_not(
    loop, monkeypatch, tmp_path, no_servers
):
    program = Path(
        shutil.copytree(
            fork_servers._PROGRAM,
            tmp_path / 'forkserver',
            ignore=shutil.ignore_patterns('__pycache__'),
        )
    )
    (tmp_path / 'of_the_course').mkdir()
    (tmp_path / 'of_the_course' / 'imported_by_a_server.py').touch()
    with (program / 'imports.py').open('a') as imports:
        imports.write(MORE.format(folder=str(tmp_path / 'of_the_course')))
    monkeypatch.setattr(fork_servers, '_PROGRAM', program)
    sandbox, kernel = loop.run(opened())
    try:
        assert kernel.why_not_forked == ''
        compiled = tmp_path.glob('of_the_course/__pycache__/*.pyc')
        assert [path.name.partition('.')[0] for path in compiled] == ['imported_by_a_server']
        assert printed(loop, kernel, 'import sys; print(sys.dont_write_bytecode)') == 'True\n'
    finally:
        loop.run(closed(sandbox, kernel))


HAS_PICTURES = "import sys; print('matplotlib.figure' in sys.modules)"


def test_an_idle_server_imports_what_draws_pictures(loop, no_servers):
    kept = [loop.run(opened())]
    try:
        server = server_of(kept[0][1])
        assert printed(loop, kept[0][1], HAS_PICTURES) == 'False\n'
        maps = Path(f'/proc/{server.pid}/maps')
        wait_until(lambda: 'matplotlib/ft2font' in maps.read_text())
        kept.append(loop.run(opened()))
        assert server_of(kept[1][1]) == server
        assert printed(loop, kept[1][1], HAS_PICTURES) == 'True\n'
        assert server.num_threads() == 1
    finally:
        for each in kept:
            loop.run(closed(*each))


def test_a_server_whose_late_import_fails_is_replaced(loop, monkeypatch, tmp_path, no_servers):
    program = Path(shutil.copytree(fork_servers._PROGRAM, tmp_path / 'forkserver'))
    with (program / 'imports.py').open('a') as imports:
        imports.write("\n_PICTURES = ('nothing_of_that_name',)\n")
    monkeypatch.setattr(fork_servers, '_PROGRAM', program)
    kept = [loop.run(opened())]
    try:
        former = server_of(kept[0][1])
        wait_until(lambda: not former.is_running() or former.status() == psutil.STATUS_ZOMBIE)
        kept.append(loop.run(opened()))
        assert server_of(kept[1][1]) != former
        assert [printed(loop, kernel, 'print(1)') for _, kernel in kept] == ['1\n', '1\n']
    finally:
        for each in kept:
            loop.run(closed(*each))


def wait_until(is_true):
    deadline = time.monotonic() + 60
    while not is_true():
        assert time.monotonic() < deadline, 'a server did not become idle in a minute'
        time.sleep(0.02)


def _held_by_a_server(room):
    code = """
import json, sys
folder, room = sys.argv[1:]
sys.path.insert(0, folder)
import imports, libc, offline, privilege_drop, single_thread
imports.import_for(room)
imports.import_when_idle()
print(json.dumps([*sys.modules]))
"""
    command = [sys.executable, '-P', '-c', code, fork_servers._PROGRAM, room]
    return set(json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout))


@pytest.mark.slow
def test_kernels_of_students_and_tests_come_from_different_servers(loop, forked):
    sandbox, test = loop.run(opened(room='test'))
    try:
        assert server_of(test) != server_of(forked)
    finally:
        loop.run(closed(sandbox, test))


def test_a_server_that_has_died_is_replaced(loop, forked):
    former = server_of(forked)
    former.kill()
    while former.is_running() and former.status() != psutil.STATUS_ZOMBIE:
        time.sleep(0.01)
    sandbox, kernel = loop.run(opened())
    try:
        assert server_of(kernel).is_running()
        assert forked.alive  # what it had forked lives on
        assert loop.run(forked.run('1', timeout_sec=60.0)).ran_to_end
    finally:
        loop.run(closed(sandbox, kernel))


@pytest.mark.slow
def test_several_kernels_can_be_forked_at_once_and_by_several_threads():
    kernels = []

    async def some():
        opened_ones = await asyncio.gather(*(opened() for _ in range(3)))
        try:
            runs = [kernel.run('print(1)', timeout_sec=60.0) for _, kernel in opened_ones]
            kernels.extend(run.ran_to_end for run in await asyncio.gather(*runs))
        finally:
            await asyncio.gather(*(closed(*each) for each in opened_ones))

    threads = [threading.Thread(target=lambda: asyncio.run(some())) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert kernels == [True] * 6


GRADER = """
import asyncio, time, sys
sys.path[:0] = [{root!r}, {root!r} + '/tests']
from forked_kernels import opened, server_of
async def main():
    kept = await opened()
    print(server_of(kept[1]).pid, flush=True)
    {then}
asyncio.run(main())
"""


@pytest.mark.slow
@pytest.mark.parametrize('then', ['time.sleep(1000)', 'return'], ids=['killed', 'ended'])
def test_no_server_outlives_its_grader(then):
    code = GRADER.format(root=str(ROOT), then=then)
    grader = subprocess.Popen([sys.executable, '-c', code], stdout=subprocess.PIPE, text=True)
    server = psutil.Process(int(grader.stdout.readline()))
    if then != 'return':
        grader.send_signal(signal.SIGKILL)
    grader.wait(60)
    assert psutil.wait_procs([server], timeout=60)[1] == []


def test_a_process_forked_from_a_grader_does_not_keep_its_servers(forked):
    if os.fork() == 0:
        os._exit(len(fork_servers._servers))
    assert os.waitstatus_to_exitcode(os.wait()[1]) == 0
    assert fork_servers._servers


PROCESSES = "import os; print(sorted(p for p in os.listdir('/proc') if p.isdigit()))"
FAULTS = {
    'a thread': (
        'import threading, time; threading.Thread(target=time.sleep, args=(1e6,)).start()',
        'started threads',
    ),
    'shared memory': ('import mmap, sys; sys.kept = mmap.mmap(-1, 4096)', 'made shared memory'),
    'an import that fails': ('import nothing_of_that_name', 'nothing_of_that_name'),
    'its end': ('import os; os._exit(1)', 'has ended'),
}  # fmt: skip


@pytest.mark.parametrize(('fault', 'why'), FAULTS.values(), ids=FAULTS)
def test_a_kernel_that_cannot_be_forked_is_started_and_says_why(
    loop, monkeypatch, tmp_path, no_servers, fault, why
):
    program = Path(shutil.copytree(fork_servers._PROGRAM, tmp_path / 'forkserver'))
    with (program / 'imports.py').open('a') as imports:
        imports.write(f'\n_load_type_supports = lambda: exec({fault!r})\n')
    monkeypatch.setattr(fork_servers, '_PROGRAM', program)
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    kernel = GradingKernel(room='student', domain_id=DOMAIN, paths=sandbox.paths('student'))
    loop.run(kernel.start())
    try:
        assert why in kernel.why_not_forked
        commands = [process.info['cmdline'] for process in psutil.process_iter(['cmdline'])]
        assert [command for command in commands if command and str(program) in command] == []
        assert printed(loop, kernel, 'print(1)') == '1\n'
        assert printed(loop, kernel, PROCESSES) == "['1', '2']\n"
    finally:
        loop.run(closed(sandbox, kernel))


@pytest.mark.slow
def test_a_kernel_runs_a_copy_of_a_python_owned_by_the_user(loop, monkeypatch, no_servers):
    """Otherwise the room's user, who owns its file, could change it through /proc/self/exe."""
    python = Path('/proc/self/exe')
    monkeypatch.setattr(fork_servers, '_python', lambda: fork_servers._sealed_copy(python))
    sandbox, kernel = loop.run(opened())
    try:
        link = printed(loop, kernel, "import os; print(os.readlink('/proc/self/exe'))")
        assert link.startswith('/memfd:python')
        assert process_of(kernel).status() != psutil.STATUS_ZOMBIE
    finally:
        loop.run(closed(sandbox, kernel))


def test_the_copy_of_python_can_not_be_changed(tmp_path):
    (tmp_path / 'python').write_bytes(b'python')
    with fork_servers._sealed_copy(tmp_path / 'python') as copy:
        path = f'/proc/self/fd/{copy.fileno()}'
        assert Path(path).read_bytes() == b'python'
        with pytest.raises(PermissionError):
            os.truncate(path, 3)
        with pytest.raises(PermissionError):
            Path(path).write_bytes(b'x')
        with Path(path).open('r+b', buffering=0) as again, pytest.raises(PermissionError):
            again.write(b'x')


@pytest.mark.parametrize(
    ('user', 'owner', 'copied'), [(0, 0, False), (1000, 0, False), (1000, 1000, True)]
)
def test_python_is_copied_only_if_an_ordinary_user_owns_it(monkeypatch, user, owner, copied):
    monkeypatch.setattr(Path, 'stat', lambda path: type('Found', (), {'st_uid': owner}))
    monkeypatch.setattr(os, 'geteuid', lambda: user)
    with fork_servers._python() as python:
        assert (python.name != '/proc/self/exe') is copied
