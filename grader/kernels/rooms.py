"""Two kernels that share nothing but a ROS domain: the student's and the test's."""

import asyncio
import shutil
from collections.abc import Sequence
from pathlib import Path

from my_robot_basics.exchange.endings import signal_name
from my_robot_basics.session.domain import Claim, claim
from my_robot_basics.session.errors import LiveError
from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.validate.kernels.limits import CHECK_TIMEOUT_SEC, REPLY_TIMEOUT_SEC
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.questions import (
    STUDENT_COMES,
    STUDENT_GOES,
    TEST_RECEIVES,
    as_expression,
    reply_of,
)
from my_robot_basics.validate.together import gather_or_cancel

from grader.common.errors import RoomFailure
from grader.kernels.kernel_exits import Responsibility, responsible_for_memory
from grader.kernels.kernels import GradingKernel
from grader.sandbox.cgroups import MemoryEvents
from grader.sandbox.sandbox import Sandbox

SETUP_TIMEOUT_SEC = 60.0


class GradingRooms:
    """A student room and a test room for one exercise; `async with` starts and ends them."""

    def __init__(
        self,
        *,
        extra_files: Sequence[Path] = (),
        seed: str = '',
        isolated: bool = True,
        doubts: list[str] | None = None,
    ) -> None:
        """Prepare two rooms; the student's gets copies of `extra_files`, the student's own files.

        Each of them is a Python module, or a folder that is a ROS package. Unless `isolated`,
        the kernels have the grading user's rights. All rooms of an exercise share `doubts`, the
        suspected faults of student code: the first one counts as a failure of the room, which is
        judged again, the second as the student's fault.
        """
        self._extra_files = tuple(extra_files)
        self._seed = seed
        self._isolated = isolated
        self._sandbox: Sandbox | None = None
        self._claim: Claim | None = None
        self._kernels: list[GradingKernel] = []
        self._doubts = [] if doubts is None else doubts
        self._replies_sec = 0.0

    async def __aenter__(self) -> 'GradingRooms':
        """Start both kernels, and check that a message from one reaches the other."""
        try:
            await self._open()
            await gather_or_cancel(self._prepare_student(), self._prepare_test())
            files = str(self._student.paths.inside / 'given' / 'files')
            await self._prepare(self._student, STUDENT_GOES.format(files=files))
        except BaseException as error:
            await self.__aexit__()
            if isinstance(error, OSError | LiveError):
                raise RoomFailure(f'the rooms could not be opened: {error}') from error
            raise
        return self

    async def __aexit__(self, *_: object) -> None:
        """End both kernels, whatever state they are in, and release the ROS domain."""
        try:
            await self._stop_kernels()
        finally:
            if self._sandbox is not None:
                await self._sandbox.close()
            if self._claim is not None:
                self._claim.release()

    @property
    def student_alive(self) -> bool:
        """Whether the student's kernel still runs."""
        return self._student.alive

    async def run_student_cell(self, source: str, *, timeout_sec: float) -> CellRun:
        """Run one of the student's cells.

        Raises RoomFailure if the kernel ended and nothing shows that the student's code did it.
        """
        run = await self._student.run(
            source, timeout_sec=timeout_sec, used_sec=self.student_cpu_sec
        )
        if run.died and not run.leaves:
            run.ending = await self._expect_fair()
        return run

    def student_cpu_sec(self) -> float | None:
        """Return the CPU time in s that the student's room has used; None if it is not counted."""
        cgroup = self._sandbox.cgroup('student') if self._sandbox else None
        return cgroup.cpu_sec() if cgroup else None

    async def run_check(self, source: str) -> CellRun:
        """Run a grade cell, and pass its requests on to the student's kernel.

        Raises RoomFailure if the cell failed and a process of the student's was ended by something
        else than the student's code, as far as is known.
        """
        self._replies_sec, ask = 0.0, self._ask_student
        run = await self._test.run(source, timeout_sec=CHECK_TIMEOUT_SEC, on_input=ask)
        run.replies_sec = self._replies_sec if run.timed_out else 0.0
        if run.died and (ended := await self._test.ending()):
            run.crash = ended.crash
        if not run.ran_to_end:
            run.ending = await self._expect_fair()
        return run

    async def _expect_fair(self) -> str:
        """Return how the student's code ended a process of its own; '' if it is not known to have.

        Raises RoomFailure if nothing shows that the student's code did it.
        """
        memory = self._sandbox.memory_events('student') if self._sandbox else MemoryEvents()
        responsibility, why = Responsibility.STUDENTS, ''
        if ending := await self._student.ending():
            responsibility, why = ending.responsibility(memory)
        elif memory.killed:
            responsibility, why = responsible_for_memory(memory)
        elif number := self._student.foreign_signal():
            responsibility = Responsibility.NOT_SHOWN
            why = f'{signal_name(number)} ended it, but no process in its room sent that signal'
        first = not self._doubts
        if responsibility is not Responsibility.STUDENTS:
            self._doubts.append(why)
        if responsibility is Responsibility.NOT_SHOWN or (
            responsibility is Responsibility.DOUBTFUL and first
        ):
            raise RoomFailure(
                f'a process in the student room ended, and nothing proves that the answer is the '
                f'cause: {why}'
            )
        return why

    async def _ask_student(self, request: str) -> str:
        """Pass a check's request to the student's kernel; return the reply, of a bounded size."""
        watch, cpu_sec = Stopwatch(), self.student_cpu_sec
        before = cpu_sec() or 0.0
        run = await self._student.run(
            '', timeout_sec=REPLY_TIMEOUT_SEC, expressions=as_expression(request), used_sec=cpu_sec
        )
        used_sec = max((cpu_sec() or 0.0) - before, watch.free_sec())
        self._replies_sec += min(watch.wall_sec(), used_sec)
        return reply_of(run, within_sec=REPLY_TIMEOUT_SEC)

    async def _open(self) -> None:
        self._claim = claim()
        if self._isolated:
            self._sandbox = Sandbox(slot=self._claim.domain_id)
            await self._sandbox.open()
        self._student = self._kernel('student')
        self._test = self._kernel('test', seed=self._seed)

    def _kernel(self, room: str, *, seed: str = '') -> GradingKernel:
        paths = self._sandbox.paths(room) if self._sandbox else None
        assert self._claim is not None  # from _open
        kernel = GradingKernel(room=room, domain_id=self._claim.domain_id, seed=seed, paths=paths)
        self._kernels.append(kernel)
        return kernel

    async def _stop_kernels(self) -> None:
        # a check closes its nodes itself; an interpreter with rclpy may take long to exit
        polite = 'student' if self._sandbox is None else None
        stops = [kernel.stop(politely=kernel.room == polite) for kernel in self._kernels]
        failed = [e for e in await asyncio.gather(*stops, return_exceptions=True) if e]
        if failed:
            raise failed[0]

    async def _prepare_student(self) -> None:
        paths = self._student.paths
        for file in self._extra_files:
            if file.is_dir():
                shutil.copytree(file, paths.packages / file.name)
            else:
                shutil.copyfile(file, paths.files / file.name)
        await self._student.start()
        await self._prepare(self._student, STUDENT_COMES)

    async def _prepare_test(self) -> None:
        await self._test.start()
        await self._prepare(self._test, TEST_RECEIVES)

    async def _prepare(self, kernel: GradingKernel, code: str) -> None:
        run = await kernel.run(code, timeout_sec=SETUP_TIMEOUT_SEC)
        if not run.ran_to_end:
            seen = run.error.evalue if run.error else 'its setup did not run to the end'
            raise RoomFailure(f'the {kernel.room} room could not be made ready: {seen}')
