"""Both rooms are opened or neither, and they leave no process, file or domain behind."""

import asyncio
import shutil
import tempfile
import time
from pathlib import Path

import psutil
import pytest
from my_robot_basics.session import domain
from my_robot_basics.session.errors import NoFreeDomain
from two_rooms import PUBLISH

from grader.common.errors import RoomFailure
from grader.kernels import fork_servers
from grader.kernels import rooms as module
from grader.kernels.isolation import require_isolation
from grader.kernels.rooms import GradingRooms


@pytest.fixture
def left(monkeypatch):
    """Count the children, files and domains that rooms opened by a test have left."""
    folder = Path(tempfile.mkdtemp(prefix='left-', dir='/tmp'))
    monkeypatch.setattr(tempfile, 'tempdir', str(folder))
    before = {p.pid for p in psutil.Process().children(recursive=True)}
    claims = {id(c) for c in domain._held if c.fileno() >= 0}

    def left():
        children = {p.pid for p in psutil.Process().children(recursive=True)} - before
        # a server that kernels are forked from stays, and is a child until one has been forked
        children -= {server._first.pid for server in fork_servers._servers.values()}
        taken = {id(c) for c in domain._held if c.fileno() >= 0} - claims
        return len(children), len(list(folder.glob('*/*'))), len(taken)

    yield left
    shutil.rmtree(folder)


NOTHING = (0, 0, 0)


def left_at_last(left):
    """Return what is left once killed processes have had time to end."""
    deadline = time.monotonic() + 30
    while left() != NOTHING and time.monotonic() < deadline:
        time.sleep(0.02)
    return left()


FAILURES = {
    'no domain is free': ('claim', NoFreeDomain('all 101'), 'could not be opened: all 101'),
    'the disk is full': ('mkdtemp', OSError(28, 'No space left'), 'could not be opened: .*space'),
    'a file vanished': ('copyfile', FileNotFoundError(2, 'gone'), 'could not be opened: .*gone'),
}  # fmt: skip


@pytest.mark.parametrize(('what', 'error', 'why'), FAILURES.values(), ids=FAILURES)
def test_rooms_that_cannot_be_opened_count_as_a_failure_of_the_grader(
    loop, monkeypatch, tmp_path, left, what, error, why
):
    def fail(*arguments, **options):
        raise error

    places = {'claim': module, 'mkdtemp': tempfile, 'copyfile': shutil}
    (tmp_path / 'a.py').write_text('')
    monkeypatch.setattr(places[what], what, fail)
    with pytest.raises(RoomFailure, match=why):
        loop.run(
            GradingRooms(
                extra_files=[tmp_path / 'a.py'], isolated=require_isolation()
            ).__aenter__()
        )
    assert left_at_last(left) == NOTHING


PROBE = 'import sys; from my_robot_basics.exchange import probe'
NOT_READY = {
    'a room that cannot be prepared': ('import nothing', 'student room .* No module named'),
    'a probe that nobody receives': (PROBE, 'test room .* no message went from'),
    'a student room that dies': ('import os; os._exit(1)', 'student room could not be made ready'),
}  # fmt: skip


@pytest.mark.timeout(60)
@pytest.mark.parametrize(('code', 'why'), NOT_READY.values(), ids=NOT_READY)
def test_both_rooms_close_if_one_cannot_be_made_ready(loop, monkeypatch, left, code, why):
    monkeypatch.setattr(module, 'STUDENT_COMES', code)
    timeout_sec = 0.5 if code == PROBE else 3600  # what can't come any more is not waited for
    receives = module.TEST_RECEIVES.replace('receive()', f'receive({timeout_sec})')
    monkeypatch.setattr(module, 'TEST_RECEIVES', receives)
    monkeypatch.setattr(module, 'SETUP_TIMEOUT_SEC', 3600.0)
    with pytest.raises(RoomFailure, match=why):
        loop.run(GradingRooms(isolated=require_isolation()).__aenter__())
    assert left_at_last(left) == NOTHING


def test_cancelling_while_rooms_open_closes_them(loop, left):
    async def cancelled():
        task = asyncio.ensure_future(GradingRooms(isolated=require_isolation()).__aenter__())
        while left()[0] < 2:
            await asyncio.sleep(0.05)
        task.cancel()
        await task

    with pytest.raises(asyncio.CancelledError):
        loop.run(cancelled())
    assert left_at_last(left) == NOTHING


@pytest.mark.parametrize('closed', [pytest.param(True, marks=pytest.mark.isolation), False])
def test_closed_rooms_leave_no_process_file_or_domain(loop, left, closed):
    rooms = GradingRooms(isolated=closed)

    async def once():
        async with rooms:
            await rooms.run_student_cell(PUBLISH, timeout_sec=60.0)
            return left()

    # a sandbox takes a few processes of its own, and a note of its cgroups where it has some
    seen = loop.run(once())
    noted = closed and rooms._sandbox.cgroup('student') is not None
    assert seen == ((7, 2 + noted, 1) if closed else (2, 2, 1))
    assert left_at_last(left) == NOTHING
