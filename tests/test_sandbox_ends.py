"""Sandboxes open and close, and no process or file outlives one."""

import asyncio
import contextlib
import os
import signal
import subprocess
import sys
import threading
import time

import psutil
import pytest
from inside_sandbox import SLOTS, begin, run

from grader.common.errors import RoomFailure
from grader.course import ROOT
from grader.sandbox import bubblewrap
from grader.sandbox.sandbox import Sandbox

pytestmark = pytest.mark.isolation


LINGER = """
import os, subprocess, sys, time
for _ in range(2):
    if os.fork():
        break
    os.setsid()
subprocess.Popen(['sleep', '4242'], start_new_session=True)
print('.', flush=True)
time.sleep(1000)
"""


def pids(network):
    found = []
    for pid in psutil.pids():
        with contextlib.suppress(OSError):
            if os.readlink(f'/proc/{pid}/ns/net') == network:
                found.append(pid)
    return found


@pytest.mark.parametrize('code', [LINGER, LINGER.replace('time.sleep(1000)', 'os._exit(0)')])
def test_no_process_outlives_a_closed_sandbox(loop, code):
    sandbox = Sandbox(slot=next(SLOTS))
    loop.run(sandbox.open())
    network = os.readlink(f'/proc/{sandbox._holder.pid}/ns/net')
    room = begin(sandbox, code)
    room.stdout.read(1)
    assert len(pids(network)) >= 1
    loop.run(sandbox.close())
    assert pids(network) == []
    room.wait(30)


GRADER = f"""
import asyncio, subprocess, sys, time
from grader.sandbox.sandbox import Sandbox
async def main():
    sandbox = Sandbox(slot=303)
    await sandbox.open()
    paths = sandbox.paths('student')
    code = "import subprocess, time; subprocess.Popen(['sleep', '1000'], start_new_session=True); "
    code += "print(flush=True); time.sleep(1000)"
    room = subprocess.Popen([*paths.prefix, {sys.executable!r}, '-c', code], text=True,
        env=paths.environment, pass_fds=paths.pass_fds, stdout=subprocess.PIPE)
    room.stdout.readline()
    print(sandbox._holder.pid, flush=True)
    time.sleep(1000)
asyncio.run(main())
"""


def test_no_process_of_a_sandbox_outlives_a_killed_grader():
    grader = subprocess.Popen(
        [sys.executable, '-c', GRADER], stdout=subprocess.PIPE, text=True, cwd=ROOT
    )
    network = os.readlink(f'/proc/{int(grader.stdout.readline())}/ns/net')
    assert len(pids(network)) > 4
    grader.send_signal(signal.SIGKILL)
    grader.wait()
    deadline = time.monotonic() + 60
    while pids(network) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert pids(network) == []


def test_a_kill_in_the_room_kills_only_the_room(shared_sandbox):
    kill = 'import os\nos.fork()\nos.kill(-1, 9)\nos.kill(1, 9)\nos.kill(os.getpid(), 9)'
    witness = begin(shared_sandbox, "print('.', flush=True); input()", room='test')
    assert witness.stdout.read(1) == '.'
    assert run(shared_sandbox, kill) == ''
    assert begin(shared_sandbox, 'print(1)').wait(60) == 0
    witness.communicate(timeout=60)


def test_a_sandbox_that_cannot_be_made_counts_as_a_failure_of_the_grader(loop, monkeypatch):
    monkeypatch.setattr(bubblewrap, '_HOLD', 'echo nothing works >&2; exit 1')
    sandbox = Sandbox(slot=next(SLOTS))
    with pytest.raises(RoomFailure, match='the sandbox could not be made: nothing works'):
        loop.run(sandbox.open())
    loop.run(sandbox.close())
    assert not any(folder.exists() for folder in sandbox._folders.values())


def test_a_closed_sandbox_leaves_no_file_and_no_descriptor(loop):
    before = None
    for _ in range(2):
        sandbox = Sandbox(slot=next(SLOTS))
        loop.run(sandbox.open())
        assert run(sandbox, 'print(1)') == '1'
        loop.run(sandbox.close())
        loop.run(sandbox.close())  # twice does no harm
        assert not any(folder.exists() for folder in sandbox._folders.values())
        descriptors = len(os.listdir('/proc/self/fd'))
        before = before or descriptors
    assert descriptors <= before


def test_many_sandboxes_open_and_close_side_by_side(loop):
    async def once():
        sandbox = Sandbox(slot=next(SLOTS))
        await sandbox.open()
        await sandbox.close()

    async def all_at_once():
        await asyncio.gather(*(once() for _ in range(8)))

    threads = threading.active_count()
    loop.run(all_at_once())
    assert threading.active_count() <= threads + 1
