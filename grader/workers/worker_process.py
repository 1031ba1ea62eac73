"""A process that grades, from its parent's side: start, tasks, missed signs of life, end."""

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
"""A worker that misses this many signs of life hangs: two minutes, even on a busy machine."""

END_GRACE_SEC = 30.0
"""How long a worker may take to end its kernels."""

REAP_SEC = 0.02
"""Interval at which we check whether it has ended."""


class WorkerProcess:
    """A worker process; it ends when end() is called, or with the event loop that started it."""

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
        """Return the packed result of a task; None if the process ended before that."""
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
                stdout=2,  # what it prints must not get into the table on stdout
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
            process.kill()  # the connection is closed or broken: if it still runs, it is of no use
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
        """Kill a silent process; misses are counted, not seconds: the machine may have slept."""
        while self._missed < MOST_MISSED:
            await asyncio.sleep(BEAT_SEC)
            self._missed += 1
        process.kill()


async def _reap(process: subprocess.Popen) -> None:
    """Wait until the process has ended; without a thread, as Python may be shutting down."""
    deadline = time.monotonic() + END_GRACE_SEC
    while process.poll() is None:
        if time.monotonic() > deadline:
            process.kill()
        await asyncio.sleep(REAP_SEC)
