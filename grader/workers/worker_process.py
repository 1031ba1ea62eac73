"""A process that grades, as its parent sees it: start, tasks, missed beats, end."""

import asyncio
import itertools
import socket
import subprocess
import time

from grader.sandbox.limits import (
    MAX_RESULT_BYTES,
)
from grader.workers.worker import BEAT, BEAT_SEC, receive, send

MOST_MISSED = 24
"""A worker that says nothing for so many beats hangs: two minutes, on however busy a machine."""

END_GRACE_SEC = 30.0
"""What a worker may take to end its kernels."""

REAP_SEC = 0.02
"""How often it is looked whether it has ended."""


class WorkerProcess:
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
        """Kill a silent process; beats are counted, because a machine may sleep meanwhile."""
        while self._missed < MOST_MISSED:
            await asyncio.sleep(BEAT_SEC)
            self._missed += 1
        process.kill()


async def _reap(process: subprocess.Popen) -> None:
    """Wait for a process that was told to end; without a thread: Python may be ending, too."""
    deadline = time.monotonic() + END_GRACE_SEC
    while process.poll() is None:
        if time.monotonic() > deadline:
            process.kill()
        await asyncio.sleep(REAP_SEC)
