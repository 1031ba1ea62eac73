"""The Linux user that runs student code, if root grades and if an ordinary user does."""

import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from inside_sandbox import begin

from grader.course import ROOT
from grader.sandbox import sandbox as module
from grader.sandbox.bubblewrap import FIRST_USER, slot_user
from grader.sandbox.sandbox import Sandbox

pytestmark = pytest.mark.isolation


@pytest.mark.skipif(os.geteuid() != 0, reason='an ordinary user cannot become another one')
def test_root_gives_each_slot_a_user_of_its_own(loop):
    users = []
    for slot in (301, 302):
        sandbox = Sandbox(slot=slot)
        loop.run(sandbox.open())
        try:
            sleeping = begin(sandbox, "import time; print('.', flush=True); time.sleep(1000)")
            assert sleeping.stdout.read(1) == '.'
            (users_of,) = [
                process.uids()
                for process in psutil.Process(sleeping.pid).children(recursive=True)
                if process.name().startswith('python')
            ]
            users.append(set(users_of))
        finally:
            loop.run(sandbox.close())
        sleeping.wait(30)
    assert users == [{slot_user(301)}, {slot_user(302)}]


RANGES = {
    '0 0 4294967295': FIRST_USER + 7,
    '0 100000 65536': 65_528,
    '0 1000 1': None,
    '0 1000 1\n1 100000 65536': 65_529,
}


@pytest.mark.parametrize(('mapped', 'user'), RANGES.items())
def test_a_slots_user_is_one_that_the_container_has(monkeypatch, mapped, user):
    monkeypatch.setattr(module.Path, 'read_text', lambda self: mapped)
    monkeypatch.setattr(os, 'geteuid', lambda: 0)
    assert slot_user(7) == user
    monkeypatch.setattr(os, 'geteuid', lambda: 1000)
    assert slot_user(7) is None


ORDINARY = 65_534


def as_ordinary_user(home, code):
    """Run Python as an ordinary user, who can read none of our files but the course."""
    home.chmod(0o777)
    code = f'import asyncio, sys\nsys.path.insert(0, {str(ROOT)!r})\n{code}\nasyncio.run(main())'
    reachable = ['--tmpfs', f'/{ROOT.parts[1]}', '--tmpfs', f'/{Path(sys.base_prefix).parts[1]}']
    for path in dict.fromkeys([str(ROOT), sys.prefix, sys.base_prefix]):
        reachable += ['--dir', path, '--ro-bind', path, path]
    return subprocess.run(
        [
            *('bwrap', '--dev-bind', '/', '/', *reachable),
            *('--cap-add', 'CAP_SETUID', '--cap-add', 'CAP_SETGID', '--'),
            *('setpriv', f'--reuid={ORDINARY}', f'--regid={ORDINARY}', '--clear-groups'),
            *(sys.executable, '-c', code),
        ],
        env={'PATH': os.environ['PATH'], 'HOME': str(home)},
        capture_output=True,
        text=True,
        cwd='/',
    )


@pytest.mark.slow
@pytest.mark.skipif(os.geteuid() != 0, reason='we are an ordinary user')
def test_an_ordinary_user_has_the_same_sandbox(tmp_path_factory):
    code = """
from grader.kernels.rooms import GradingRooms
async def main():
    async with GradingRooms() as rooms:
        run = await rooms.run_student_cell('import os; print(os.getuid()); x = 7', timeout_sec=60)
        print(run.outputs[0].text.strip())
        run = await rooms.run_check(
            'from my_robot_basics.checks import student; print(student.value("x"))')
        print(run.outputs[0].text.strip())
        print(rooms._student.why_not_forked or 'forked')
"""
    done = as_ordinary_user(tmp_path_factory.mktemp('home'), code)
    assert done.stdout.splitlines() == ['1000', '7', 'forked'], done.stderr


UNDER_WAY = """
import os, socket
kept = []
try:
    while True:
        kept.append(socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM))
        for _ in range(8): socket.send_fds(kept[-1][0], [b'x'], [0] * 100)
except OSError as error: print(error.strerror)
"""


@pytest.mark.slow
@pytest.mark.skipif(os.geteuid() != 0, reason='we are an ordinary user')
def test_descriptors_in_flight_in_one_room_do_not_block_other_rooms(tmp_path_factory):
    code = f"""
import resource
resource.setrlimit(resource.RLIMIT_NOFILE, (1_024, 4_096))  # as for a login
from grader.kernels.rooms import GradingRooms
async def main():
    async with GradingRooms() as rooms:
        run = await rooms.run_student_cell({UNDER_WAY!r}, timeout_sec=60)
        print(run.outputs[0].text.strip())
        async with GradingRooms() as others:
            run = await others.run_student_cell('print("fine")', timeout_sec=60)
            print(run.outputs[0].text.strip())
"""
    done = as_ordinary_user(tmp_path_factory.mktemp('home'), code)
    said = ['Too many references: cannot splice', 'fine']
    assert done.stdout.splitlines() == said, done.stderr
