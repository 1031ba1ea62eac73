"""A cluster that grades in real rooms, whose scheduler is killed, or whose run is stopped."""

import contextlib
import re
import signal
import subprocess
import sys

import psutil
import pytest
from course_maker import answered, released_course, submit
from dask_processes import start_scheduler, starter, wait_for

from grader.storage.records import records

pytestmark = [pytest.mark.slow, pytest.mark.isolation, pytest.mark.timeout(900)]

SLOWLY = 'import time\n\ntime.sleep(2)\n\n\ndef double(x):\n    return {} * x'
CLASS = {'ada': 2, 'bob': 3, 'eve': 2, 'kim': 3, 'zoe': 2}
"""The factor that each student multiplies by: two of them are wrong."""
GRADE = (
    'import sys; from pathlib import Path; from grader.course import Course; '
    'from grader.__main__ import main; '
    'sys.exit(main(["grade", *sys.argv[2:]], course=Course.at(Path(sys.argv[1]))))'
)


@pytest.fixture
def start(tmp_path):
    yield from starter(tmp_path)


def start_cluster(start, port=0):
    scheduler = start_scheduler(start, port)
    return scheduler, start('worker', scheduler.address, '--nthreads', '2', '--no-nanny')


def handed_in(root):
    course = released_course(root)
    for student, factor in CLASS.items():
        submit(course, student, answered(course, SLOWLY.format(factor)))
    return course


def grade(course, *options):
    return subprocess.Popen(
        [sys.executable, '-P', '-c', GRADE, str(course.root), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def scores(course):
    return [(r.student_id, r.grade_id, r.score) for r in records(course)]


def until_one_is_stored(run):
    assert any(line.startswith('ada') for line in iter(run.stdout.readline, '')), run.communicate()


def test_grading_resumes_after_a_scheduler_was_killed_with_the_same_scores(tmp_path, start):
    scheduler, _ = start_cluster(start)
    there = handed_in(tmp_path / 'there')
    run = grade(there, '--dask', scheduler.address)
    until_one_is_stored(run)
    scheduler.kill()
    told, said = run.communicate(timeout=300)
    assert run.returncode == 1
    assert 'not graded' not in told  # the run ends, and gives nobody up
    assert 'run the same command again, and it goes on' in said
    assert len({student for student, *_ in scores(there)}) < len(CLASS)
    again, _ = start_cluster(start, port=scheduler.address.rpartition(':')[2])
    run = grade(there, '--dask', again.address)
    told, said = run.communicate(timeout=300)
    assert run.returncode == 0, said
    assert '(unchanged)' in told
    here = handed_in(tmp_path / 'here')
    assert grade(here).wait(300) == 0
    assert scores(there) == scores(here)
    assert {student for student, *_ in scores(here)} == CLASS.keys()


def test_ctrl_c_leaves_nothing_running_on_a_cluster(tmp_path, start):
    scheduler, worker = start_cluster(start)
    course = handed_in(tmp_path / 'course')
    run = grade(course, '--dask', scheduler.address)
    until_one_is_stored(run)
    run.send_signal(signal.SIGINT)
    _, said = run.communicate(timeout=300)
    assert run.returncode == 130
    told = re.search(r'course: stopped. (\d) of 5 submissions are graded and stored; run it', said)
    assert 1 <= int(told[1]) <= len({student for student, *_ in scores(course)}) < 5
    assert 'Traceback' not in said
    wait_for(lambda: rooms(worker) == [])
    worker.send_signal(signal.SIGTERM)
    worker.wait(120)


def rooms(worker):
    """Return the commands of the sandboxes that a worker has."""
    found = []
    with contextlib.suppress(psutil.Error):
        for process in psutil.Process(worker.pid).children(recursive=True):
            with contextlib.suppress(psutil.Error):
                found += [' '.join(process.cmdline())] * (process.name() == 'bwrap')
    return found
