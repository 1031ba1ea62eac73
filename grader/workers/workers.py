"""Processes of this machine that grade; one that dies or hangs is replaced."""

import os
import sys
from concurrent.futures import Future
from typing import Self

from grader.common.available_memory import available_bytes
from grader.common.errors import TaskFailed
from grader.common.pool import Pool
from grader.judging.task import GradingTask, Result, pack, unpack
from grader.kernels.isolation import require_isolation
from grader.sandbox.cgroup_hierarchies import command_in_scope
from grader.sandbox.limits import (
    IN_FLIGHT_EACH,
    MOST_IN_FLIGHT,
    MOST_IN_FLIGHT_EACH,
    SUBMISSION_MEMORY_BYTES,
)
from grader.workers.adaptive_semaphore import AdaptiveSemaphore
from grader.workers.worker_process import WorkerProcess

COMMAND = (sys.executable, '-P', '-m', 'grader.workers.begin_worker')
TRIES = 3


class Workers:
    """Grades tasks in worker processes; the end of `with` ends them and all that they run."""

    def __init__(
        self,
        number: int | None = None,
        *,
        in_flight: int | None = None,
        command: tuple[str, ...] | None = None,
    ) -> None:
        """Use `number` processes, by default one for each core; they start when there is work.

        Together they grade `in_flight` submissions at a time, by default as many as the processors
        can take, and never more than memory allows.
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
        self._command = command or command_in_scope(COMMAND)
        self._processes: list[WorkerProcess] = []
        self._pool = Pool(self.capacity)
        self._entered = 0

    def __enter__(self) -> Self:
        """Begin to take tasks; a nested `with` changes nothing."""
        if not self._entered:
            self._pool.__enter__()
        self._entered += 1
        return self

    def __exit__(self, *exception: object) -> None:
        """End what still runs, at the end of the outermost `with`."""
        self._entered -= 1
        if not self._entered:
            self._pool.__exit__(*exception)

    def begin(self) -> None:
        """Start the first process: it imports while this process continues."""
        if not self._processes:
            self._pool.submit(self._start)

    async def _start(self) -> None:
        if not self._processes:
            self._idlest_worker()

    def require_isolation(self, *, trust_students: bool = False) -> bool:
        """Return whether student code runs in a sandbox. Raises CourseError if it has to."""
        return require_isolation(trust_students=trust_students)

    def submit(self, task: GradingTask) -> 'Future[Result]':
        """Grade a task when there is room. The future raises TaskFailed if there is no result."""
        return self._pool.submit(self._grade, task)

    def submit_text(self, text: str) -> 'Future[str]':
        """Grade a packed task; the future has the packed result."""
        return self._pool.submit(self._grade_text, text)

    async def _grade(self, task: GradingTask) -> Result:
        return unpack(await self._grade_text(pack(task)), task)

    async def _grade_text(self, text: str) -> str:
        async with self._gate:
            return await self._grade_with_retries(text)

    async def _grade_with_retries(self, text: str) -> str:
        answer = await self._idlest_worker().grade(text)
        for _ in range(TRIES - 1):
            if answer is None:  # in a new process alone, where no other submission can end it
                alone = WorkerProcess(self._command)
                try:
                    answer = await alone.grade(text)
                finally:
                    await alone.end()
        if answer is None:
            raise TaskFailed(f'the process that graded it ended before it was done, {TRIES} times')
        return answer

    def _idlest_worker(self) -> 'WorkerProcess':
        """Return the worker with the fewest tasks, or a new one if all have enough.

        A worker takes some seconds to start: for two submissions that is not worthwhile.
        """
        self._processes = [worker for worker in self._processes if not worker.ended]
        idlest = min(self._processes, key=lambda worker: worker.load, default=None)
        if idlest is None or (idlest.load >= self._each and len(self._processes) < self._number):
            idlest = WorkerProcess(self._command)
            self._processes.append(idlest)
        return idlest
