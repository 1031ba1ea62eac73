"""Two kernels that share nothing but a ROS domain: the student's and the test's."""

import ast
import asyncio
import json
import shutil
from collections.abc import Sequence
from pathlib import Path

from my_robot_basics.live.domain import claim

from grader.errors import RoomFailure
from grader.kernels import Kernel
from grader.outputs import CellRun

REPLY_TIMEOUT_SEC = 10.0
"""How long the student's kernel may take to answer one question of a check."""
MAX_REPLY_CHARACTERS = 65_536
CHECK_TIMEOUT_SEC = 90.0
"""A check has time limits of its own; this one ends a check that lost them."""
SETUP_TIMEOUT_SEC = 60.0

_RESPONDER = (
    "__import__('my_robot_basics.checks.responder', fromlist=['answer']).answer({request!r})"
)


class Rooms:
    """A student room and a test room for one exercise; `async with` starts and ends them."""

    def __init__(self, *, extra_files: Sequence[Path] = (), seed: str = '') -> None:
        """Prepare two rooms; the student's gets a copy of the submission's own modules."""
        self._extra_files = tuple(extra_files)
        self._seed = seed

    async def __aenter__(self) -> 'Rooms':
        """Start both kernels, and see a message cross from one to the other."""
        self._claim = claim()
        domain_id = self._claim.domain_id
        self._student = Kernel(room='student', domain_id=domain_id)
        self._test = Kernel(room='test', domain_id=domain_id, seed=self._seed)
        try:
            await asyncio.gather(self._student.start(), self._test.start())
            await asyncio.gather(
                self._prepare(self._student, self._student_code()),
                self._prepare(self._test, 'from my_robot_basics.checks import probe'),
            )
            await self._probe()
        except BaseException:
            await self.__aexit__()
            raise
        return self

    async def __aexit__(self, *_: object) -> None:
        """End both kernels, whatever state they are in, and give the domain back."""
        await asyncio.gather(self._student.stop(), self._test.stop())
        self._claim.release()

    @property
    def student_alive(self) -> bool:
        """Whether the student's kernel still runs."""
        return self._student.alive

    async def run_student_cell(self, source: str, *, timeout_sec: float) -> CellRun:
        """Run one of the student's cells."""
        return await self._student.run(source, timeout_sec=timeout_sec)

    async def run_check(self, source: str) -> CellRun:
        """Run a grade cell, passing its questions on to the student's kernel."""
        return await self._test.run(
            source, timeout_sec=CHECK_TIMEOUT_SEC, on_input=self._ask_student
        )

    async def _ask_student(self, request: str) -> str:
        """Take one question of a check over, and text of a bounded size back."""
        run = await self._student.run(
            '', timeout_sec=REPLY_TIMEOUT_SEC, expressions={'reply': _responder(request)}
        )
        if run.died:
            return _failed('the kernel of your notebook has ended')
        if run.timed_out:
            return _failed(f'no answer within {REPLY_TIMEOUT_SEC:.0f} s')
        text = run.expressions.get('reply', {}).get('data', {}).get('text/plain', '')
        if len(text) > MAX_REPLY_CHARACTERS:
            return _failed(f'an answer of {len(text):,} characters')
        try:
            reply = ast.literal_eval(text)
        except (ValueError, SyntaxError, MemoryError, RecursionError):
            reply = None
        return reply if isinstance(reply, str) else _failed('no usable answer')

    def _student_code(self) -> str:
        lines = ['from my_robot_basics.live import classroom', 'classroom.enter()']
        if self._extra_files:
            folder = self._student.folder / 'files'
            folder.mkdir()
            for file in self._extra_files:
                shutil.copyfile(file, folder / file.name)
            # last, so that they shadow nothing
            lines += ['import sys', f'sys.path.append({str(folder)!r})']
        return '\n'.join([*lines, 'from my_robot_basics.checks import probe'])

    async def _probe(self) -> None:
        """See that a node in the student room reaches the test room, before any student code."""
        await self._prepare(self._student, 'probe.announce()')
        await self._prepare(self._test, 'probe.hear()')
        await self._prepare(self._student, 'probe.silence(); del probe')

    async def _prepare(self, kernel: Kernel, code: str) -> None:
        run = await kernel.run(code, timeout_sec=SETUP_TIMEOUT_SEC)
        if not run.ran_to_end:
            seen = run.error.evalue if run.error else 'it did not end'
            raise RoomFailure(f'the {kernel.room} room could not be made ready: {seen}')


def _responder(request: str) -> str:
    return _RESPONDER.format(request=request)


def _failed(sentence: str) -> str:
    return json.dumps({'failed': sentence})
