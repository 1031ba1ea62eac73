"""The programs of the course that a notebook has started, directly or by another program."""

import sys
import time

import psutil
import pytest
from my_robot_basics.live.nodes import course_nodes

TIMEOUT_SEC = 60.0
SLEEPS = 'import time; time.sleep(600)'
NAMED = 'my_robot_basics.kinematics_publisher'
STARTS_ANOTHER = f"""
import subprocess, sys
name = '.'.join(['my_robot_basics', 'kinematics_publisher'])
subprocess.run([sys.executable, '-c', {SLEEPS!r}, name])
"""
"""The name of the program is not in the command line of the process that starts it."""

pytestmark = pytest.mark.starts


@pytest.fixture
def start():
    started = []

    def start(code, *arguments):
        started.append(psutil.Popen([sys.executable, '-c', code, *arguments]))
        return psutil.Process(started[-1].pid)

    yield start
    for process in started:
        for each in [*process.children(recursive=True), process]:
            each.kill()
        process.wait()


def found(*, besides=()):
    """Wait until a program is found: one may start another a while after its own start."""
    until = time.monotonic() + TIMEOUT_SEC
    while not (names := course_nodes.programs(besides=besides)) and time.monotonic() < until:
        time.sleep(0.05)
    return names


@pytest.mark.parametrize(
    ('code', 'arguments'), [(STARTS_ANOTHER, []), (SLEEPS, [NAMED])], ids=['by another', 'itself']
)
def test_a_course_program_is_found_also_if_another_program_started_it(start, code, arguments):
    child = start(code, *arguments)
    names = found()
    assert [*names.values()] == ['kinematics_publisher']
    assert not course_nodes.programs(besides=[child])


def test_a_program_of_another_package_with_the_same_name_is_not_found(start):
    start(SLEEPS, 'my_robot_basics_of_mine.kinematics_publisher')
    own = start(SLEEPS, NAMED)
    assert [*found()] == [own]
