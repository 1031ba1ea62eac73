"""Ctrl-C and the like while a class is graded in real rooms; SIGKILL, which nobody can answer."""

import os
import signal
import subprocess
import sys
import time

import psutil
import pytest
from course_maker import TOY, answered, make_course, submit

from grader.__main__ import main
from grader.gradebook import register
from grader.records import records
from grader.release import release

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
    course = make_course(tmp_path)
    release(course)
    register(course, TOY)
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


def kernels_of(run):
    """Wait until both kernels of a submission run; return all processes of the run."""
    deadline, sessions = time.monotonic() + 120, set()
    while time.monotonic() < deadline and run.poll() is None:
        below = psutil.Process(run.pid).children(recursive=True)
        commands = {process: ' '.join(_command(process)) for process in below}
        started = [p for p, command in commands.items() if 'ipykernel_launcher' in command]
        sessions |= {p.pid for p, command in commands.items() if 'forkserver.py' in command}
        # they leave their parent, and keep the session that they began
        servers = [p for p in psutil.process_iter() if _session(p) in sessions and p not in below]
        forked = [kernel for kernels in map(_below, servers) for kernel in kernels]
        if len(started) + sum(bool(_below(server)) for server in servers) >= 2:
            return below + servers + forked
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
    _, left = psutil.wait_procs(processes, timeout=30)
    return [process for process in left if process.status() != psutil.STATUS_ZOMBIE]


@pytest.mark.parametrize(
    'number',
    [signal.SIGINT, signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.slow)],
)
def test_a_run_that_is_stopped_leaves_nothing_running_and_says_how_to_go_on(course, run, number):
    assert any(line.startswith('ada') for line in iter(run.stdout.readline, ''))
    below = kernels_of(run)
    run.send_signal(number)
    _, err = run.communicate(timeout=240)
    assert run.returncode == 128 + number
    assert (
        'course: stopped. 1 of 2 submissions are graded and stored; run it again to go on.' in err
    )
    assert 'Traceback' not in err
    assert not alive(below)
    assert {r.student_id for r in records(course)} == {'ada'}


def test_a_run_that_is_killed_takes_its_kernels_with_it_and_is_done_again(course, run):
    below = kernels_of(run)
    run.kill()
    run.communicate()
    assert not alive(below)
    submit(course, 'bob', b'no notebook either')
    assert main(['grade', '--trust-students'], course=course) == 0
    assert {r.student_id for r in records(course)} == {'ada', 'bob'}
