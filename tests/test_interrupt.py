"""Ctrl-C, SIGTERM, SIGHUP and SIGKILL while a class is graded in real rooms."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import time
from typing import NamedTuple

import psutil
import pytest
from course_maker import answered, released_course, submit

from grader.__main__ import main
from grader.storage.records import records

ENDLESS = 'import time\n\nwhile True:\n    time.sleep(0.1)'
GRADE = (
    'import sys\n'
    'from pathlib import Path\n'
    'from grader.__main__ import main\n'
    'from grader.course import Course\n'
    'sys.exit(main(["grade", "--trust-students"], course=Course.at(Path(sys.argv[1]))))\n'
)


@pytest.fixture
def course(tmp_path):
    course = released_course(tmp_path)
    submit(course, 'ada', b'no notebook')
    submit(course, 'bob', answered(course, ENDLESS))
    return course


@pytest.fixture
def run(course):
    command = [sys.executable, '-P', '-c', GRADE, str(course.root)]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    yield run
    run.kill()
    run.communicate()


class Processes(NamedTuple):
    below: list[psutil.Process]
    servers: list[psutil.Process]
    forked: list[psutil.Process]


def kernels_of(run):
    """Wait until both kernels of a submission run; return all processes of the run, sorted out.

    Below it are its workers, their rooms, and kernels that were started. Fork servers and the
    kernels that they fork are no descendants of it: call this while the run starts them.
    """
    deadline, sessions = time.monotonic() + 120, set()
    while time.monotonic() < deadline and run.poll() is None:
        below = psutil.Process(run.pid).children(recursive=True)
        commands = {process: ' '.join(_command(process)) for process in below}
        started = [p for p, command in commands.items() if 'ipykernel_launcher' in command]
        sessions |= {p.pid for p, command in commands.items() if 'forkserver' in command}
        # fork servers leave their parent, and keep the session that they began
        servers = [p for p in psutil.process_iter() if _session(p) in sessions and p not in below]
        forked = [kernel for kernels in map(_below, servers) for kernel in kernels]
        if len(started) + sum(bool(_below(server)) for server in servers) >= 2:
            return Processes(below, servers, forked)
        time.sleep(0.1)
    pytest.fail(f'no kernels: {run.communicate()}')


def _below(process):
    try:
        return process.children(recursive=True)
    except psutil.Error:
        return []


def _session(process):
    try:
        return os.getsid(process.pid)
    except ProcessLookupError:
        return None


def _command(process):
    try:
        return process.cmdline()
    except psutil.Error:
        return []


def alive(processes):
    """Wait until all processes end; return those that still run."""
    _, left = psutil.wait_procs([one for each in processes for one in each], timeout=30)
    return [process for process in left if process.status() != psutil.STATUS_ZOMBIE]


@pytest.mark.slow
@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_run_that_is_stopped_leaves_nothing_running_and_says_how_to_go_on(course, run, number):
    below = kernels_of(run)
    assert any(line.startswith('ada') for line in iter(run.stdout.readline, ''))
    run.send_signal(number)
    _, err = run.communicate(timeout=240)
    assert run.returncode == 128 + number
    assert (
        'course: stopped. 1 of 2 submissions are graded and stored; run it again to go on.' in err
    )
    assert 'Traceback' not in err
    assert not alive(below)
    assert {r.student_id for r in records(course)} == {'ada'}


@pytest.mark.slow
def test_a_killed_run_ends_its_kernels_and_can_be_repeated(course, run):
    below = kernels_of(run)
    run.kill()
    run.communicate()
    assert not alive(below)
    submit(course, 'bob', b'no notebook either')
    assert main(['grade', '--trust-students'], course=course) == 0
    assert {r.student_id for r in records(course)} == {'ada', 'bob'}


def killed(found):
    """Kill the workers that are grading, with all processes that they have started."""
    for process in found.below:
        if 'grader.workers.begin_worker' in ' '.join(_command(process)):
            process.kill()
    return found


def killed_servers(found):
    """Kill the processes that fork kernels."""
    for process in found.servers:
        with contextlib.suppress(psutil.NoSuchProcess):  # one may be on its way out
            process.kill()
    return Processes([], found.servers, [])


@pytest.fixture
def slow_ones(course):
    """Three slow submissions instead of one that never ends; list this fixture before `run`."""
    shutil.rmtree(course.folder('submitted', 'bob', ''))
    slowly = 'import time\n\ntime.sleep(3)\n\n\ndef double(x):\n    return 2 * x'
    for name in ('carl', 'dora', 'eve'):
        submit(course, name, answered(course, slowly))


@pytest.mark.isolation
@pytest.mark.slow  # test_workers.py kills workers, and test_fork_servers.py servers
@pytest.mark.parametrize('kill', [killed, killed_servers])
def test_killed_workers_or_fork_servers_change_no_grade(course, slow_ones, run, kill):
    found = kernels_of(run)
    assert found.servers
    assert not alive(kill(found))
    out, _ = run.communicate(timeout=240)
    assert run.returncode == 0, out
    scores = {(r.student_id, r.score) for r in records(course) if r.grade_id == 'double-hidden'}
    assert scores == {('ada', 0.0), ('carl', 2.0), ('dora', 2.0), ('eve', 2.0)}
