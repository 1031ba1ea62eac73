"""Linux counts what a room uses, and enforces its limits; no cgroup is left."""

import dataclasses
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from forked_kernels import DOMAIN, SLOTS, closed, opened

from grader.common.errors import RoomFailure
from grader.kernels import fork_servers
from grader.kernels.kernels import GradingKernel
from grader.sandbox import cgroups as module
from grader.sandbox.cgroup_hierarchies import NoCgroups, hierarchies
from grader.sandbox.cgroups import MemoryEvents, join_command, remove_cgroup
from grader.sandbox.limits import ROOM_MEMORY_BYTES, ROOM_PROCESSES
from grader.sandbox.sandbox import Sandbox
from grader.sandbox.temporary_folders import remove_stale_folders

pytestmark = pytest.mark.isolation


@pytest.fixture(autouse=True)
def needs_cgroups():
    try:
        hierarchies()
    except NoCgroups as problem:
        pytest.skip(f'no cgroup can be had here: {problem}')


@pytest.fixture
def sandbox(loop):
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    yield sandbox
    loop.run(sandbox.close())


@pytest.fixture(params=['forked', 'started'])
def kernels(request, loop, sandbox):
    """The kernels of both rooms of a sandbox."""

    async def begin():
        kernels = {}
        with pytest.MonkeyPatch.context() as patch:
            for room in ('student', 'test'):
                if request.param == 'started':
                    patch.setitem(fork_servers._unfit, room, 'the test says so')
                kernels[room] = GradingKernel(
                    room=room, domain_id=DOMAIN, paths=sandbox.paths(room)
                )
                await kernels[room].start()
                assert bool(kernels[room].why_not_forked) is (request.param == 'started')
        return kernels

    async def end():
        for kernel in kernels.values():
            await kernel.stop(politely=False)

    kernels = loop.run(begin())
    yield kernels
    loop.run(end())


def ran(loop, kernel, code):
    return loop.run(kernel.run(code, timeout_sec=60.0))


def pids(cgroup, controller='memory'):
    return {int(pid) for pid in (cgroup.folders[controller] / 'cgroup.procs').read_text().split()}


@pytest.mark.slow
def test_a_kernel_and_its_child_processes_are_in_the_rooms_cgroup(loop, sandbox, kernels):
    for room, kernel in kernels.items():
        cgroup = sandbox.cgroup(room)
        before = pids(cgroup)
        ran(loop, kernel, "import subprocess; p = subprocess.Popen(['sleep', '1000'])")
        for controller in cgroup.folders:
            assert len(pids(cgroup, controller) - before) == 1
    student, test = (pids(sandbox.cgroup(room)) for room in ('student', 'test'))
    assert not student & test
    assert os.getpid() not in student | test


LIMIT = 300_000_000
BOMBS = {
    'its own': "kept = b'x' * 900_000_000",
    'shared, and out of sight': """
import mmap
kept = mmap.mmap(-1, 900_000_000)
for i in range(0, len(kept), 4096):
    kept[i] = 1
    if not i % 4_096_000: kept.madvise(mmap.MADV_DONTNEED)
""",
    'of sockets': """
import socket
kept = []
for _ in range(500):
    pair = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    pair[0].setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 10_000_000)
    pair[0].setblocking(False)
    kept.append(pair)
    try:
        while True: pair[0].send(bytes(100_000))
    except BlockingIOError: pass
""",
}


@pytest.mark.parametrize('code', BOMBS.values(), ids=BOMBS)
def test_memory_of_all_kinds_counts_against_the_limit_of_its_room_only(loop, monkeypatch, code):
    monkeypatch.setattr(module, 'ROOM_MEMORY_BYTES', LIMIT)
    sandbox, student = loop.run(opened())
    test = GradingKernel(room='test', domain_id=DOMAIN, paths=sandbox.paths('test'))
    loop.run(test.start())
    rooms = [sandbox.cgroup(room) for room in ('student', 'test')]
    assert [room.memory_limit_bytes for room in rooms] == [LIMIT, LIMIT]
    assert [room.memory_events() for room in rooms] == [MemoryEvents(), MemoryEvents()]
    assert ran(loop, student, code).died
    assert ran(loop, test, "print(len(b'x' * 100_000_000))").outputs[0].text == '100000000\n'
    loop.run(test.stop(politely=False))
    loop.run(closed(sandbox, student))
    assert rooms[0].memory_events().killed >= 1
    assert rooms[0].memory_events().limit_reached
    assert rooms[1].memory_events() == MemoryEvents()


def test_a_rooms_cgroup_has_the_configured_limits(sandbox):
    cgroup = sandbox.cgroup('student')
    assert cgroup.memory_limit_bytes == ROOM_MEMORY_BYTES
    name = 'memory.max' if cgroup.version == 2 else 'memory.limit_in_bytes'
    assert int((cgroup.folders['memory'] / name).read_text()) == ROOM_MEMORY_BYTES
    most = int((cgroup.folders['pids'] / 'pids.max').read_text())
    assert ROOM_PROCESSES <= most <= ROOM_PROCESSES + 20
    if not (cpu := cgroup.folders.get('cpu')):
        pytest.skip('no controller of processors can be had here')
    name, one = ('cpu.weight', 100) if cgroup.version == 2 else ('cpu.shares', 1024)
    weights = [int((folder / name).read_text()) for folder in (cpu, cpu.parent)]
    assert weights == [one, 2 * one]  # a sandbox has twice that of a room, for it has two


def test_closing_a_sandbox_kills_its_processes_and_removes_its_cgroups(loop):
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    folders = sandbox._cgroups.folders
    assert all(folder.is_dir() for folder in folders)
    command = [
        *join_command(sandbox.cgroup('student')),
        'sh',
        '-c',
        'sleep 4241 & echo; exec sleep 4241',
    ]
    strangers = subprocess.Popen(command, stdout=subprocess.PIPE, start_new_session=True)
    strangers.stdout.readline()
    assert len(pids(sandbox.cgroup('student'))) == 2
    loop.run(sandbox.close())
    assert not any(folder.exists() for folder in folders)
    assert strangers.wait(60) == -signal.SIGKILL
    strangers.stdout.close()


def test_a_command_that_cannot_join_its_cgroup_does_not_run(sandbox):
    cgroup = sandbox.cgroup('student')
    nowhere = {name: folder / 'nowhere' for name, folder in cgroup.folders.items()}
    command = [*join_command(dataclasses.replace(cgroup, folders=nowhere)), 'echo', 'it ran']
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode != 0, done.stdout) == (True, '')
    assert 'nowhere' in done.stderr


def test_cgroups_that_cannot_be_made_are_reported_as_a_room_failure(loop):
    sandbox = Sandbox(slot=next(SLOTS))
    in_the_way = sandbox._cgroups.folders[0]
    in_the_way.mkdir()
    with pytest.raises(RoomFailure, match='cgroups of a sandbox could not be made'):
        loop.run(sandbox.open())
    loop.run(sandbox.close())
    assert not in_the_way.exists()


GRADER = """
import asyncio, subprocess, time
from grader.sandbox.sandbox import Sandbox
async def main():
    sandbox = Sandbox(slot=304)
    await sandbox.open()
    paths = sandbox.paths('student')
    subprocess.Popen([*paths.prefix, 'sleep', '4240'], env=paths.environment,
                     pass_fds=paths.pass_fds)
    print(*sandbox._cgroups.folders, sep=chr(0), flush=True)
    time.sleep(1000)
asyncio.run(main())
"""


def test_cgroups_of_a_killed_grader_are_removed_by_the_next_sweep(tmp_path):
    with tempfile.TemporaryDirectory(prefix='mrb-test-') as temporary:
        command = [sys.executable, '-P', '-c', GRADER]
        with subprocess.Popen(
            command, env=os.environ | {'TMPDIR': temporary}, stdout=subprocess.PIPE, text=True
        ) as grader:
            left = [Path(path) for path in grader.stdout.readline().strip().split('\0')]
            assert remove_stale_folders(Path(temporary)) == []
            assert all(path.is_dir() for path in left)  # its grader still runs
            grader.kill()
        assert all(path.is_dir() for path in left)
        assert len(remove_stale_folders(Path(temporary))) == 1
        assert not any(path.exists() for path in left)


def test_a_process_of_another_pid_namespace_is_not_killed(tmp_path):
    # 0 stands for a process in another PID namespace; to kill 0 would be to kill this one
    (tmp_path / 'cgroup.procs').write_text('0\n')
    assert not remove_cgroup(tmp_path)
