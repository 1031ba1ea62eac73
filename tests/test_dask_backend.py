import signal
import subprocess
import sys
from contextlib import suppress
from importlib.metadata import version
from threading import Event
from types import SimpleNamespace

import psutil
import pytest
from course_maker import answered, released_course, submit
from dask_processes import TESTS, start_scheduler, starter, wait_for

from grader.__main__ import main
from grader.common.errors import ClusterError, TaskFailed
from grader.course import Course
from grader.grade import grade_all
from grader.judging.task import GradingTask
from grader.storage.records import records
from grader.storage.submitted import find_submissions
from grader.workers import dask_backend
from grader.workers.dask_backend import Cluster
from grader.workers.dask_client import Certificates, connect
from grader.workers.workers import Workers

LOCALLY = (sys.executable, str(TESTS / 'toy_worker.py'))
RIGHT = 'def double(x):\n    return 2 * x'
WRONG = 'def double(x):\n    return x + 1'
ANSWERS = {'ada': RIGHT, 'bob': WRONG, 'eve': RIGHT, 'kim': WRONG, 'zoe': RIGHT}


@pytest.fixture(autouse=True)
def software_hash(monkeypatch):
    """What toy_dask_worker.py reports about itself."""
    monkeypatch.setattr(dask_backend, 'software_hash', lambda: f'toy, numpy {version("numpy")}')


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('cluster'))


@pytest.fixture
def start(tmp_path):
    yield from starter(tmp_path)


@pytest.fixture
def scheduler(start):
    return start_scheduler(start)


def start_worker(start, address, *more, **environment):
    options = [*more, '--nthreads', '2', '--no-nanny', '--preload', 'toy_dask_worker']
    return start('worker', address, *options, **environment)


def handed_in(course, folder, first_lines=None):
    """Return a course whose students have submitted the ANSWERS."""
    its = Course(root=course.root, gradebook=folder)
    folder.mkdir()
    (folder / 'gradebook.db').write_bytes(course.database.read_bytes())
    (folder / 'course_secret').write_text('ab' * 32)
    for student, answer in ANSWERS.items():
        first = (first_lines or {}).get(student, '')
        submit(its, student, answered(its, f'{first}\n{answer}'))
    return its


def scores(course):
    return [(r.student_id, r.grade_id, r.score, r.comment) for r in records(course)]


def grades(worker):
    """Whether a worker of the cluster has begun to grade."""
    with suppress(psutil.Error):  # its processes come and go
        return any('toy_' in str(p.cmdline()) for p in psutil.Process(worker.pid).children())


@pytest.mark.slow
def test_a_cluster_grades_as_this_machine_does_and_a_lost_worker_changes_nothing(
    course, scheduler, start, tmp_path
):
    workers = [start_worker(start, scheduler.address) for _ in range(2)]
    mark = tmp_path / 'go'
    waits = dict.fromkeys(('bob', 'eve', 'kim'), f'# wait {mark}')
    there = handed_in(course, tmp_path / 'there', waits)
    with Cluster(scheduler.address) as backend:
        failing = backend.submit(
            GradingTask(notebook=answered(course, f'# fail\n{RIGHT}'), seed='abc')
        )
        with pytest.raises(TaskFailed, match=r'^OSError: no room$'):
            failing.result()
    rows = grade_all(there, find_submissions(there), backend=Cluster(scheduler.address))
    names = [next(rows).student_id]
    wait_for(lambda: grades(workers[0]))
    workers[0].send_signal(signal.SIGKILL)
    mark.touch()
    names += [row.student_id for row in rows]
    assert names == sorted(ANSWERS)
    here = handed_in(course, tmp_path / 'here', waits)
    list(grade_all(here, find_submissions(here), backend=Workers(2, command=LOCALLY)))
    assert scores(there) == scores(here)
    assert len(scores(there)) == 3 * len(ANSWERS)


@pytest.mark.slow
def test_a_run_that_lost_its_scheduler_can_be_continued_with_a_new_one(
    course, scheduler, start, tmp_path, capsys
):
    start_worker(start, scheduler.address)
    mark = tmp_path / 'go'
    there = handed_in(course, tmp_path / 'there', {'eve': f'# wait {mark}'})
    rows = grade_all(there, find_submissions(there), backend=Cluster(scheduler.address))
    done = [next(rows).student_id, next(rows).student_id]
    scheduler.send_signal(signal.SIGKILL)
    with pytest.raises(ClusterError, match='run the same command again, and it goes on'):
        next(rows)
    mark.touch()
    again = start_scheduler(start, port=scheduler.address.rpartition(':')[2])
    start_worker(start, again.address)
    assert main(['grade', '--dask', again.address], course=there) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines if '(unchanged)' in line] == done
    assert {record.student_id for record in records(there)} == ANSWERS.keys()


@pytest.mark.parametrize(
    ('environment', 'said'),
    [
        ({'TOY_MISSING': 'no bubblewrap here'}, 'refuses: no bubblewrap here'),
        ({'TOY_NUMPY': '0.1'}, 'would not grade as this machine does: numpy 0.1, and [1-9]'),
    ],
)
def test_a_worker_that_differs_from_this_machine_grades_nothing(
    scheduler, start, environment, said
):
    start_worker(start, scheduler.address, **environment)
    with pytest.raises(ClusterError, match=said), Cluster(scheduler.address):
        pass


@pytest.mark.slow
def test_a_worker_that_joins_later_is_checked_too(course, scheduler, start):
    good = start_worker(start, scheduler.address)
    with Cluster(scheduler.address) as backend:
        good.kill()
        start_worker(start, scheduler.address, TOY_MISSING='no bubblewrap here')
        work = backend.submit(GradingTask(notebook=answered(course, RIGHT), seed='abc'))
        with pytest.raises(ClusterError, match='refuses: no bubblewrap here'):
            work.result()


@pytest.mark.slow
def test_leaving_a_cluster_cancels_its_running_and_waiting_tasks(
    course, scheduler, start, tmp_path
):
    start_worker(start, scheduler.address)
    task = GradingTask(notebook=answered(course, f'# wait {tmp_path / "go"}\n{RIGHT}'), seed='abc')
    with connect(scheduler.address, Certificates()) as onlooker:

        def known():
            return onlooker.run_on_scheduler(lambda dask_scheduler: len(dask_scheduler.tasks))

        with Cluster(scheduler.address) as backend:
            works = [backend.submit(task) for _ in range(6)]
            wait_for(lambda: known() == len(works))
        wait_for(lambda: known() == 0)
    assert all(isinstance(work.exception(timeout=60), ClusterError) for work in works)


def test_a_client_that_has_given_up_its_scheduler_is_no_longer_watched(monkeypatch):
    monkeypatch.setattr(dask_backend, 'LOOK_SEC', 0.0)
    its = SimpleNamespace(_left=Event(), _address='', _client=SimpleNamespace(scheduler_info=dict))
    Cluster._warn_without_workers(its)  # returns, and says nothing
    assert not its._left.is_set()


@pytest.mark.slow
def test_a_cluster_with_certificates_is_reached_by_tls_alone(course, start, tmp_path):
    cert, key = str(tmp_path / 'cert.pem'), str(tmp_path / 'key.pem')
    own = ['openssl', 'req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1']
    name = ['-subj', '/CN=toy', '-addext', 'subjectAltName=IP:127.0.0.1']
    subprocess.run([*own, '-nodes', '-keyout', key, '-out', cert, *name], check=True)
    tls = ['--tls-ca-file', cert, '--tls-cert', cert, '--tls-key', key]
    scheduler = start_scheduler(start, options=['--protocol', 'tls', *tls])
    assert scheduler.address.startswith('tls://')
    start_worker(start, scheduler.address, *tls)
    there = handed_in(course, tmp_path / 'there')
    assert main(['grade', '--dask', scheduler.address, *tls], course=there) == 0
    assert {record.student_id for record in records(there)} == ANSWERS.keys()
    with pytest.raises(ClusterError, match='needs certificates'), Cluster(scheduler.address):
        pass
    unencrypted = scheduler.address.replace('tls:', 'tcp:')
    with pytest.raises(ClusterError, match='no scheduler at'), Cluster(unencrypted):
        pass
