import itertools
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest
from course_maker import answered, released_course, submit
from my_robot_basics.session import pressure

from grader.common.errors import TaskFailed
from grader.course import Course
from grader.grade import grade_all
from grader.judging.task import GradingTask, pack
from grader.sandbox.limits import SUBMISSION_MEMORY_BYTES
from grader.storage.records import records
from grader.storage.submitted import find_submissions
from grader.workers import worker, worker_process, workers
from grader.workers.workers import Workers

COMMAND = (sys.executable, str(Path(__file__).with_name('toy_worker.py')))
RIGHT = 'def double(x):\n    return 2 * x'
WRONG = 'def double(x):\n    return x + 1'


@pytest.fixture(scope='module')
def course(tmp_path_factory):
    return released_course(tmp_path_factory.mktemp('workers'))


def task(course, first_line=''):
    return GradingTask(notebook=answered(course, f'{first_line}\n{RIGHT}'), seed='abc')


def pid_of(result):
    assert result.notebook.metadata.my_robot_basics.seed == 'abc'
    return int(notes_of(result)[0])


def notes_of(result):
    lines = result.notebook.cells[-2].outputs[0].text.splitlines()
    return [line.removeprefix('note: ') for line in lines if line.startswith('note: ')]


def outcomes(result):
    cells = result.notebook.cells
    return [c.metadata.my_robot_basics.outcome for c in cells if 'my_robot_basics' in c.metadata]


def team():
    """The worker processes that this test has started and that have not ended."""
    return [
        process for process in psutil.Process().children() if 'toy_worker' in _command(process)
    ]


def _command(process):
    try:
        return ' '.join(process.cmdline())
    except psutil.Error:
        return ''


def wait_for(happened):
    deadline = time.monotonic() + 120
    while not happened():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def test_the_requested_number_of_workers_grades_and_ends_with_the_run(course, tmp_path):
    mark = tmp_path / 'go'
    with Workers(2, command=COMMAND) as backend:
        under_way = [backend.submit(task(course, f'# wait {mark}')) for _ in range(6)]
        wait_for(lambda: len(team()) == 2)
        mark.touch()
        results = [work.result() for work in under_way]
        processes = team()
    assert len({pid_of(result) for result in results}) == 2
    assert [outcomes(result) for result in results] == [['passed', 'passed']] * 6
    assert all(result.seconds > 0 for result in results)
    assert not any(process.is_running() for process in processes)


@pytest.mark.slow
def test_a_worker_is_filled_to_its_load_before_another_one_is_started(course, tmp_path):
    mark, loads = tmp_path / 'go', []
    with Workers(2, command=COMMAND) as backend:
        for number in (1, 2, 3):
            backend.submit(task(course, f'# wait {mark}'))
            wait_for(lambda number=number: sum(w.load for w in backend._processes) == number)
            loads.append([worker.load for worker in backend._processes])
        mark.touch()
    assert loads == [[1], [2], [2, 1]]


def test_no_worker_is_started_without_a_submission():
    with Workers(2, command=COMMAND):
        assert team() == []


def test_a_failure_in_a_worker_is_raised_with_its_traceback(course):
    with Workers(1, command=COMMAND) as backend:
        with pytest.raises(TaskFailed, match=r'^OSError: no room$') as failed:
            backend.submit(task(course, '# fail')).result()
        assert "raise OSError('no room')" in failed.value.trace


@pytest.mark.slow
def test_submissions_of_a_killed_worker_are_graded_by_its_replacement(course, tmp_path):
    mark = tmp_path / 'go'
    with Workers(1, in_flight=3, command=COMMAND) as backend:
        first = pid_of(backend.submit(task(course)).result())
        under_way = [backend.submit(task(course, f'# wait {mark}')) for _ in range(3)]
        wait_for(lambda: team()[0].pid == first)
        team()[0].send_signal(signal.SIGKILL)
        mark.touch()
        pids = {pid_of(work.result()) for work in under_way}
        assert first not in pids
        assert pid_of(backend.submit(task(course)).result()) not in pids | {first}


def test_a_submission_that_kills_its_workers_does_not_affect_others(course, tmp_path):
    with Workers(1, in_flight=3, command=COMMAND) as backend:
        works = [backend.submit(task(course, line)) for line in ('', '# die', '')]
        works.append(backend.submit(task(course, f'# die once {tmp_path / "mark"}')))
        with pytest.raises(TaskFailed, match='ended before it was done, 3 times'):
            works.pop(1).result()
        for work in works:
            assert outcomes(work.result()) == ['passed', 'passed']


@pytest.mark.slow
def test_a_worker_that_hangs_is_replaced(course, tmp_path, monkeypatch):
    mark = tmp_path / 'stopped'
    monkeypatch.setattr(worker_process, 'BEAT_SEC', 0.1)
    monkeypatch.setattr(worker_process, 'MOST_MISSED', 10_000)
    with Workers(1, command=COMMAND) as backend:
        work = backend.submit(task(course, f'# stop {mark}'))
        wait_for(mark.exists)
        (hung,) = team()
        (worker,) = backend._processes
        wait_for(lambda: worker._missed > 50)
        monkeypatch.setattr(worker_process, 'MOST_MISSED', 50)
        wait_for(lambda: worker.ended)
        # the next one may take its time
        monkeypatch.setattr(worker_process, 'MOST_MISSED', 10_000)
        assert pid_of(work.result()) != hung.pid
        assert not hung.is_running()


def test_a_looping_worker_ends_itself_after_the_run_has_gone(course, tmp_path):
    ours, theirs = socket.socketpair()
    with ours, theirs:
        fd = theirs.fileno()
        process = subprocess.Popen([*COMMAND, str(fd)], pass_fds=[fd], stderr=subprocess.DEVNULL)
        text = pack(task(course, f'# loop {tmp_path / "mark"}')).encode()
        ours.sendall(worker._HEAD.pack(1, len(text)) + text)
        wait_for((tmp_path / 'mark').exists)
    try:
        assert process.wait(timeout=120) == -signal.SIGALRM
    finally:
        process.kill()


def test_a_child_process_of_a_worker_inherits_only_the_standard_streams(course):
    with Workers(1, command=COMMAND) as backend:
        result = backend.submit(task(course, '# child')).result()
    assert notes_of(result)[1] == '0 1 2'


@pytest.mark.slow
def test_a_worker_that_announces_too_large_a_result_is_given_up(course):
    with Workers(1, command=COMMAND) as backend:
        with pytest.raises(TaskFailed, match='ended before it was done, 3 times'):
            backend.submit(task(course, '# endless')).result()
        assert outcomes(backend.submit(task(course)).result()) == ['passed', 'passed']


@pytest.mark.parametrize(('stalled_share', 'allowed'), [(0.0, 3), (1.0, 2)])
def test_more_submissions_are_in_flight_while_processors_are_idle(
    course, tmp_path, monkeypatch, stalled_share, allowed
):
    stalled_sec = itertools.count(1.0, 60.0 * stalled_share)
    watch = SimpleNamespace(wall_sec=lambda: 60.0)
    monkeypatch.setattr(pressure, 'Stopwatch', lambda: watch)
    monkeypatch.setattr(pressure, 'stalled_sec', lambda: next(stalled_sec))
    mark = tmp_path / 'go'
    with Workers(1, command=COMMAND) as backend:
        backend.submit(task(course)).result()
        under_way = [backend.submit(task(course, f'# wait {mark}')) for _ in range(8)]
        (worker,) = backend._processes
        wait_for(lambda: worker.load == allowed == backend._gate.allowed)
        mark.touch()
        assert [outcomes(work.result()) for work in under_way] == [['passed', 'passed']] * 8


@pytest.mark.parametrize('in_flight', [1, 7])
def test_no_more_submissions_are_in_flight_than_requested(in_flight):
    backend = Workers(2, in_flight=in_flight)
    assert backend.capacity == backend._gate.allowed == in_flight


def test_available_memory_limits_the_submissions_in_flight(monkeypatch):
    rooms = []
    for submissions in (0, 1, 2.5, 1000):
        left = int(submissions * SUBMISSION_MEMORY_BYTES)
        monkeypatch.setattr(workers, 'available_bytes', lambda left=left: left)
        backend = Workers(2)
        rooms.append((backend._gate.allowed, backend.capacity))
    assert rooms == [
        (1, 1),
        (1, 1),
        (2, 2),
        (2 * workers.IN_FLIGHT_EACH, 2 * workers.MOST_IN_FLIGHT_EACH),
    ]


@pytest.mark.slow
def test_killed_workers_change_no_grade(course, tmp_path):
    graded = []
    for name in ('whole', 'killed'):
        its = Course(root=course.root, gradebook=tmp_path / name)
        mark = tmp_path / f'{name} goes'
        (its.gradebook).mkdir()
        (its.gradebook / 'gradebook.db').write_bytes(course.database.read_bytes())
        (its.gradebook / 'course_secret').write_text('ab' * 32)
        for student, answer in (('ada', RIGHT), ('bob', WRONG), ('eve', RIGHT), ('kim', WRONG)):
            first = f'# wait {mark}\n' if student in ('bob', 'eve') else ''
            submit(its, student, answered(its, f'{first}{answer}'))
        rows = grade_all(its, find_submissions(its), backend=Workers(2, command=COMMAND))
        names = [next(rows).student_id]
        if name == 'killed':
            for process in team():
                process.send_signal(signal.SIGKILL)
        mark.touch()
        names += [row.student_id for row in rows]
        assert names == ['ada', 'bob', 'eve', 'kim']
        graded.append([(r.student_id, r.grade_id, r.score) for r in records(its)])
    assert graded[0] == graded[1]
