"""Processes of this machine that grade; one that dies or hangs is replaced."""

import asyncio
import itertools
import os
import socket
import subprocess
import sys
import time
from concurrent.futures import Future
from typing import Self

from grader.common.available_memory import available_bytes
from grader.common.errors import TaskFailed
from grader.common.pool import Pool
from grader.judging.task import Result, Task, pack, unpack
from grader.kernels.isolation import require_isolation
from grader.sandbox.cgroup_hierarchies import scoped
from grader.sandbox.limits import (
    IN_FLIGHT_EACH,
    MAX_RESULT_BYTES,
    MOST_IN_FLIGHT,
    MOST_IN_FLIGHT_EACH,
    SUBMISSION_MEMORY_BYTES,
)
from grader.workers.adaptive_semaphore import AdaptiveSemaphore
from grader.workers.worker import BEAT, BEAT_SEC, receive, send

COMMAND = (sys.executable, '-P', '-m', 'grader.workers.worker')
MOST_MISSED = 24
"""A worker that says nothing for so many beats hangs: two minutes, on however busy a machine."""
END_GRACE_SEC = 30.0
"""What a worker may take to end its kernels."""
REAP_SEC = 0.02
"""How often it is looked whether it has ended."""
TRIES = 3


class Workers:
    """Grades tasks in worker processes; leaving the `with` ends them and all that they run."""

    def __init__(
        self,
        number: int | None = None,
        *,
        in_flight: int | None = None,
        command: tuple[str, ...] | None = None,
    ) -> None:
        """Use so many processes, by default one for each core, as soon as there is work for them.

        They have no more than `in_flight` submissions together, by default what the processors
        can take; and no more than memory allows.
        """
        self._number = number or len(os.sched_getaffinity(0))
        least = in_flight or IN_FLIGHT_EACH * self._number
        most = max(least, min(MOST_IN_FLIGHT_EACH * self._number, MOST_IN_FLIGHT))
        fit = max(1, available_bytes() // SUBMISSION_MEMORY_BYTES)
        self.capacity = min(in_flight or most, fit)
        self._gate = AdaptiveSemaphore(
            least=min(least, fit), most=self.capacity, step=self._number
        )
        self._each = -(-least // self._number)
        self._command = command or scoped(COMMAND)
        self._team: list[_Worker] = []
        self._pool = Pool(self.capacity)

    def __enter__(self) -> Self:
        """Begin to take tasks."""
        self._pool.__enter__()
        return self

    def __exit__(self, *exception: object) -> None:
        """End what still runs."""
        self._pool.__exit__(*exception)

    def require_isolation(self, *, trust_students: bool = False) -> bool:
        """Return whether student code runs in a sandbox; raises CourseError where it must."""
        return require_isolation(trust_students=trust_students)

    def submit(self, task: Task) -> 'Future[Result]':
        """Grade a task as soon as there is room. The future raises TaskFailed for no result."""
        return self._pool.submit(self._graded, task)

    def submit_text(self, text: str) -> 'Future[str]':
        """Grade a packed task; the future brings what came of it, packed."""
        return self._pool.submit(self._tried, text)

    async def _graded(self, task: Task) -> Result:
        return unpack(await self._tried(pack(task)), task)

    async def _tried(self, text: str) -> str:
        async with self._gate:
            return await self._answer(text)

    async def _answer(self, text: str) -> str:
        answer = await self._next().grade(text)
        for _ in range(TRIES - 1):
            if answer is None:  # alone, so that nobody else's submission can end it
                alone = _Worker(self._command)
                try:
                    answer = await alone.grade(text)
                finally:
                    await alone.end()
        if answer is None:
            raise TaskFailed(f'the process that graded it ended before it was done, {TRIES} times')
        return answer

    def _next(self) -> '_Worker':
        """Return the worker that has least to do; a new one where all have enough to do.

        One takes some seconds to begin: for two submissions it is not worth while.
        """
        self._team = [worker for worker in self._team if not worker.ended]
        idlest = min(self._team, key=lambda worker: worker.load, default=None)
        if idlest is None or (idlest.load >= self._each and len(self._team) < self._number):
            idlest = _Worker(self._command)
            self._team.append(idlest)
        return idlest


class _Worker:
    """One process; it ends when it is told to, or with the event loop that it was made on."""

    def __init__(self, command: tuple[str, ...]) -> None:
        self._command = command
        self._numbers = itertools.count(BEAT + 1)
        self._asked: dict[int, asyncio.Future[str | None]] = {}
        self._writer: asyncio.StreamWriter | None = None
        self._connected = asyncio.Event()
        self._missed = 0
        self._life = asyncio.create_task(self._live())
        self.ended = False

    @property
    def load(self) -> int:
        """How many tasks it has."""
        return len(self._asked)

    async def grade(self, text: str) -> str | None:
        """Return what came of a packed task; None where the process ended before it."""
        number = next(self._numbers)
        answer = self._asked[number] = asyncio.get_running_loop().create_future()
        try:
            await self._connected.wait()
            if self.ended:
                return None
            assert self._writer is not None  # it is connected and has not ended
            await send(self._writer, number, text)
            return await answer
        except ConnectionError:
            return None
        finally:
            del self._asked[number]

    async def end(self) -> None:
        """End the process and all that it runs."""
        self._life.cancel()
        await asyncio.gather(self._life, return_exceptions=True)

    async def _live(self) -> None:
        ours, theirs = socket.socketpair()
        with theirs:
            process = subprocess.Popen(
                [*self._command, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=2,  # whatever prints there, the table is not disturbed
                start_new_session=True,  # the process that started the run handles Ctrl-C
            )
        watch = asyncio.create_task(self._watch(process))
        try:
            reader, self._writer = await asyncio.open_connection(sock=ours)
            self._connected.set()
            while found := await receive(reader, most=MAX_RESULT_BYTES):
                self._missed = 0
                answer = self._asked.get(found[0])
                if answer is not None and not answer.done():
                    answer.set_result(found[1])
            process.kill()  # if it has not ended, it has lost its way
        finally:
            self.ended = True
            self._connected.set()
            for answer in self._asked.values():
                if not answer.done():
                    answer.set_result(None)
            watch.cancel()
            if self._writer:
                self._writer.close()
            await _reap(process)

    async def _watch(self, process: subprocess.Popen) -> None:
        """Kill a process that has gone silent; counted, for a machine may sleep meanwhile."""
        while self._missed < MOST_MISSED:
            await asyncio.sleep(BEAT_SEC)
            self._missed += 1
        process.kill()


async def _reap(process: subprocess.Popen) -> None:
    """Wait for a process that was told to end; without a thread, for Python may be ending, too."""
    deadline = time.monotonic() + END_GRACE_SEC
    while process.poll() is None:
        if time.monotonic() > deadline:
            process.kill()
        await asyncio.sleep(REAP_SEC)
