"""A cluster of two hosts, network namespaces, that speak TLS: one is lost in the middle."""

import random
import subprocess
import sys
import time

import psutil
import pytest
from dask_processes import starter, wait_for
from sample_class import FOLDER, hand_in
from two_hosts import HERE, THERE, Authority, Hosts

from grader.course import ROOT, Course
from grader.storage.records import records

pytestmark = [pytest.mark.slow, pytest.mark.isolation, pytest.mark.timeout(1800)]

NAMES = sorted(path.stem for path in FOLDER.glob('*.ipynb'))
GRADE = (
    'import sys; from pathlib import Path; from grader.course import Course; '
    'from grader.__main__ import main; '
    'sys.exit(main(["grade", *sys.argv[2:]], course=Course(gradebook=Path(sys.argv[1]))))'
)


@pytest.fixture
def hosts():
    hosts = Hosts()
    yield hosts
    hosts.end()


@pytest.fixture
def start(tmp_path, hosts):  # they end before the hosts do
    yield from starter(tmp_path)


@pytest.fixture
def ours(tmp_path):
    return Authority(tmp_path / 'ours')


@pytest.fixture
def scheduler(start, hosts, ours):
    """A scheduler on this host."""
    options = ('--protocol', 'tls', '--host', HERE, '--port', '8786', *ours.options('scheduler'))
    process = start('scheduler', *options, on=hosts.on(HERE))
    wait_for(lambda: 'Scheduler at:' in process.log.read_text(), process)
    process.address = f'tls://{HERE}:8786'
    return process


def start_worker(start, hosts, host, scheduler, authority):
    options = ('--nthreads', '2', *authority.options(f'worker-{host}'))
    return start('worker', scheduler.address, *options, on=hosts.on(host))


def handed_in(gradebook):
    course = Course(root=ROOT, gradebook=gradebook)
    gradebook.mkdir()
    (gradebook / 'course_secret').write_text('ab' * 32)
    hand_in(course, NAMES)
    return course


def grade(course, *options, on=()):
    return subprocess.Popen(
        [*on, sys.executable, '-P', '-c', GRADE, str(course.gradebook), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def scores(course):
    return [(r.student_id, r.grade_id, r.score, r.max_score, r.comment) for r in records(course)]


def rooms(worker):
    """Return how many sandboxes a worker has."""
    names = []
    for process in psutil.Process(worker.pid).children(recursive=True):
        try:
            names.append(process.name())
        except psutil.NoSuchProcess:
            continue
    return names.count('bwrap')


def test_a_host_that_is_lost_during_grading_changes_no_score(
    tmp_path, hosts, start, scheduler, ours
):
    workers = {host: start_worker(start, hosts, host, scheduler, ours) for host in (HERE, THERE)}
    for worker in workers.values():
        wait_for(lambda worker=worker: 'Registered to' in worker.log.read_text(), worker)
    there = handed_in(tmp_path / 'there')
    number = len(NAMES)
    chance = random.Random()
    after, delay = chance.randrange(1, number // 2), chance.uniform(0, 3)
    print(f'lost {delay:.2f} s after row {after} of {number}')  # shown where it fails
    options = ('--dask', scheduler.address, *ours.options('course'))
    run = grade(there, *options, on=hosts.on(HERE))
    for _ in range(1 + after):  # the first line is the heading
        run.stdout.readline()
    time.sleep(delay)
    wait_for(lambda: rooms(workers[THERE]) > 0)
    hosts.lose(THERE, workers[THERE])
    told, said = run.communicate(timeout=1200)
    assert run.returncode == 0, said
    assert 'Traceback' not in said
    assert f'Remove worker addr: tls://{THERE}:' in scheduler.log.read_text()
    assert 'not graded' not in told
    here = handed_in(tmp_path / 'here')
    alone = grade(here)
    _, said = alone.communicate(timeout=1200)
    assert alone.returncode == 0, said
    assert scores(there) == scores(here)
    assert len({student for student, *_ in scores(there)}) == number


def test_a_host_without_tls_or_with_a_foreign_certificate_is_refused(
    tmp_path, hosts, start, scheduler, ours
):
    course = handed_in(tmp_path / 'course')
    theirs = Authority(tmp_path / 'theirs')

    def refused(address, *options):
        run = grade(course, '--dask', address, *options, on=hosts.on(THERE))
        _, said = run.communicate(timeout=300)
        assert run.returncode == 1
        assert 'Traceback' not in said, said
        return said

    assert 'use tls:// there' in refused(scheduler.address.replace('tls:', 'tcp:'))
    assert 'needs certificates' in refused(scheduler.address)
    told = refused(scheduler.address, *theirs.options('course'))
    assert 'has a certificate of another authority' in told
    mixed = [
        *ours.options('course')[:2],
        *theirs.options('course')[2:],
    ]  # the scheduler does not know us
    assert f'no scheduler at {scheduler.address} that answers' in refused(
        scheduler.address, *mixed
    )
    worker = start_worker(start, hosts, THERE, scheduler, theirs)
    assert worker.wait(120) != 0
    assert 'CERTIFICATE_VERIFY_FAILED' in worker.log.read_text()
    assert 'has no workers' in refused(scheduler.address, *ours.options('course'))
    assert records(course) == []
