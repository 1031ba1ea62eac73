"""The two kernels of *Validate*: as at grading, but on the student's own machine."""

import asyncio
import math
import shutil
import tempfile
from collections.abc import Callable, Coroutine, Sequence
from pathlib import Path

from my_robot_basics.session.domain import Claim, claim
from my_robot_basics.session.errors import LiveError
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.forks import ForkServer
from my_robot_basics.validate.kernels.kernel import LocalKernel
from my_robot_basics.validate.kernels.limits import (
    REPLY_TIMEOUT_SEC,
    VALIDATE_TIMEOUT_SEC,
)
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.questions import (
    STUDENT_COMES,
    STUDENT_GOES,
    TEST_RECEIVES,
    as_expression,
    reply_of,
)
from my_robot_basics.validate.lessons.titles import title_of_check
from my_robot_basics.validate.running.checks_budget import ChecksBudget
from my_robot_basics.validate.together import gather_or_cancel
from my_robot_basics.validate.verdicts.overdue import rounded_down

SETUP_TIMEOUT_SEC = 60.0
SLOW_SEC = 1.0
"""A cell that takes longer is named in the progress line."""
MOST_PATH = 60
"""Longest usable path of a temporary folder: a Unix socket's path has about 100 characters."""

Say = Callable[[str], None]


class LocalRooms:
    """A student's kernel and a test's for one exercise; `async with` starts and ends them."""

    say: Say = staticmethod(lambda line: None)
    """Called with a line about each step that begins."""
    end_later: Callable[[Coroutine], object] | None = None
    """Called with the coroutine that ends the kernels, to run it later; not after a failure."""

    def __init__(
        self, *, files: Sequence[Path], server: ForkServer, beside: Path = Path()
    ) -> None:
        """Prepare two kernels of a server; the student's kernel can import copies of `files`.

        ROS packages are searched in the folder `beside`, which is the notebook's.
        """
        self._files, self._server, self._beside = files, server, beside
        self._claim: Claim | None = None
        self._folder: Path | None = None
        self._kernels: list[LocalKernel] = []
        self._checks = ChecksBudget()
        self._unanswered: CellRun | None = None
        """The request that was given up, if any."""

    async def __aenter__(self) -> 'LocalRooms':
        """Start both kernels and send the probe message between them. Raises RoomFailure."""
        self.say('starting two kernels')
        try:
            folder = self._open()
            await gather_or_cancel(
                self._prepare(self._student, STUDENT_COMES),
                self._prepare(self._test, TEST_RECEIVES),
            )
            await self._run_ours(self._student, STUDENT_GOES.format(files=str(folder / 'files')))
        except BaseException as error:
            await self.__aexit__()
            if isinstance(error, OSError | LiveError):
                raise RoomFailure(f'no kernels could be started: {error}') from error
            raise
        return self

    async def __aexit__(self, failed: object = True, *_: object) -> None:
        """End both kernels in any state, and remove their folder and ROS domain."""
        if failed is None and self.end_later is not None:
            self.end_later(self._end())
        else:
            await self._end()

    async def _end(self) -> None:
        try:
            # only the student's kernel may still have nodes, which can hold shared memory
            stops = [k.stop(politely=k is self._kernels[0]) for k in self._kernels]
            await asyncio.gather(*stops)
        finally:
            if self._folder is not None:
                shutil.rmtree(self._folder, ignore_errors=True)
            if self._claim is not None:
                self._claim.release()

    @property
    def student_alive(self) -> bool:
        """Whether the student's kernel still runs."""
        return self._student.alive

    async def run_student_cell(
        self,
        source: str,
        *,
        timeout_sec: float,
        free_sec: float = math.inf,
        number: int = 0,
        builds: str = '',
    ) -> CellRun:
        """Run one of the student's cells; give it up after `free_sec` with a free processor.

        `number` is the cell's number in the notebook, and `builds` the package that it builds.
        """
        what = f'building {builds} with colcon, which takes a few seconds'
        self.say(what if builds else f'running your cells ({number})')
        waits = f'waiting for cell {number}, which has not returned yet'
        slow_sec = math.inf if builds else SLOW_SEC
        later = asyncio.get_running_loop().call_later(slow_sec, self.say, waits)
        try:
            return await self._student.run(source, timeout_sec=timeout_sec, free_sec=free_sec)
        finally:
            later.cancel()

    def student_cpu_sec(self) -> None:
        """Return None: processor time is not measured on the student's own machine."""

    async def run_check(self, source: str) -> CellRun:
        """Run a grade cell, and pass its requests on to the student's kernel."""
        self.say(f'checking: {title_of_check(source)}')
        run = await self._checks.run(self._test, source, on_input=self._ask_student)
        if self._unanswered is not None and not run.ran_to_end:
            run.cut_after_sec = self._unanswered.cut_after_sec
        return run

    async def _ask_student(self, request: str) -> str:
        """Pass a request on; after one was not answered in time, no other one is sent."""
        run = self._unanswered or await self._student.run(
            '',
            timeout_sec=REPLY_TIMEOUT_SEC,
            free_sec=VALIDATE_TIMEOUT_SEC,
            expressions=as_expression(request),
        )
        if run.cut_after_sec:
            self._unanswered = run
        within_sec = rounded_down(run.cut_after_sec or REPLY_TIMEOUT_SEC)
        at_grading_sec = REPLY_TIMEOUT_SEC if run.cut_after_sec else 0.0
        return reply_of(run, within_sec=within_sec, at_grading_sec=at_grading_sec)

    def _open(self) -> Path:
        """Create and return the kernels' folder, and prepare both kernels in it."""
        self._claim = owned = claim()
        short = None if len(tempfile.gettempdir()) < MOST_PATH else '/tmp'
        self._folder = folder = Path(tempfile.mkdtemp(prefix='validate-', dir=short))
        (folder / 'files').mkdir()
        for file in self._files:
            shutil.copyfile(file, folder / 'files' / file.name)
        self._student = self._kernel(folder / 'student', owned.domain_id)
        self._test = self._kernel(folder / 'test', owned.domain_id)
        return folder

    def _kernel(self, folder: Path, domain_id: int) -> LocalKernel:
        """Return a kernel for the room that the folder is named after."""
        environment = {
            'MY_ROBOT_BASICS_ROOM': folder.name,
            'MY_ROBOT_BASICS_ADVICE': '1',
            'MY_ROBOT_BASICS_DOMAIN_ID': str(domain_id),
            'RCUTILS_LOGGING_USE_STDOUT': '1',
            # the student's own workspace must not be changed by the cells that are run
            'MY_ROBOT_BASICS_WORKSPACE': str(folder / 'ros_ws'),
            # packages are only read there: the build copies them
            'MY_ROBOT_BASICS_PACKAGES': str(self._beside.resolve()),
            'ROS_LOG_DIR': str(folder / 'ros_log'),
            'MPLBACKEND': 'module://matplotlib_inline.backend_inline',
            'PYTHONSAFEPATH': '1',
        }
        self._kernels.append(LocalKernel(folder, environment, self._server))
        return self._kernels[-1]

    async def _prepare(self, kernel: LocalKernel, code: str) -> None:
        await kernel.start()
        await self._run_ours(kernel, code)

    async def _run_ours(self, kernel: LocalKernel, code: str) -> None:
        run = await kernel.run(code, timeout_sec=SETUP_TIMEOUT_SEC)
        if not run.ran_to_end:
            why = run.error.evalue if run.error else 'it did not end'
            raise RoomFailure(f'a kernel could not be made ready: {why}')
