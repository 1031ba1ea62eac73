"""Fork kernels from a process that has already imported what they need."""

import asyncio
import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import threading
import uuid
from pathlib import Path
from typing import Self

import psutil

from my_robot_basics.validate.errors import RoomFailure

_MARK = 'MY_ROBOT_BASICS_VALIDATE'
"""The environment variable that marks all processes of one ForkServer with its id."""
_END_SEC = 5.0


class ForkServer:
    """A process that forks kernels; `with` ends it, and all processes that they left running."""

    def __init__(self) -> None:
        """Start the process, which does its imports in the background."""
        self._mark = uuid.uuid4().hex
        self._asking = threading.Lock()
        self._process = subprocess.Popen(
            [sys.executable, '-P', '-m', 'my_robot_basics.validate.kernels.forkserver'],
            env=os.environ | {_MARK: self._mark},
            cwd='/',
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            text=True,
        )

    def __enter__(self) -> Self:
        """Return this server, which is already started."""
        return self

    def __exit__(self, *_: object) -> None:
        """End the server, and processes that students' code has started and left running."""
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            self._process.communicate(timeout=_END_SEC)
        self._process.kill()
        self._process.wait()
        _end_marked(_MARK, self._mark)

    async def fork(
        self, folder: Path, environment: dict[str, str], arguments: list[str]
    ) -> 'ForkedKernel':
        """Fork a kernel with this working directory. Raises RoomFailure if the server ended."""
        order = {
            'folder': str(folder),
            'environment': environment | {_MARK: self._mark},
            'arguments': arguments,
        }
        try:
            return ForkedKernel(await asyncio.to_thread(self._ask, json.dumps(order)))
        except asyncio.CancelledError:
            self._process.kill()  # its reply to this order would be taken for that to the next
            raise

    def _ask(self, order: str) -> int:
        assert self._process.stdin is not None  # both are pipes
        assert self._process.stdout is not None
        with self._asking:
            try:
                print(order, file=self._process.stdin, flush=True)
                return int(self._process.stdout.readline())
            except (OSError, ValueError):
                raise RoomFailure('the process that forks kernels has ended') from None


class ForkedKernel:
    """A kernel's process, which leads a session of its own."""

    def __init__(self, pid: int) -> None:
        """Open a process that was just forked."""
        self._pid = pid
        try:
            self._file = os.pidfd_open(pid)
        except ProcessLookupError:
            self._file = -1

    @property
    def alive(self) -> bool:
        """Whether the kernel's process still runs."""
        return self._file >= 0 and not select.select([self._file], [], [], 0)[0]

    def busy_sec(self) -> float:
        """Return the processor time, in seconds, of its main thread, which runs the cells."""
        with contextlib.suppress(psutil.Error):
            threads = {thread.id: thread for thread in psutil.Process(self._pid).threads()}
            return threads[self._pid].user_time + threads[self._pid].system_time
        return 0.0

    def interrupt(self) -> None:
        """Send SIGINT to the kernel's process group."""
        self._send(signal.SIGINT)

    async def kill(self) -> None:
        """Kill the kernel's process group, and wait for the end of the kernel."""
        self._send(signal.SIGKILL)
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self.ended(), _END_SEC)

    async def ended(self) -> None:
        """Wait for the end of the kernel's process."""
        while self.alive:
            await asyncio.sleep(0.01)

    def close(self) -> None:
        """Close the pidfd; to be called when the kernel has ended."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _send(self, number: int) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._pid, number)


def _end_marked(name: str, mark: str) -> None:
    """Kill all processes, as far as permitted, whose environment variable `name` is `mark`."""
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.environ().get(name) == mark:
                process.kill()
