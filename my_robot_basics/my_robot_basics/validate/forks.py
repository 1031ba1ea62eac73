"""Fork kernels from a process that has imported already what they need."""

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

from my_robot_basics.session import marked_processes
from my_robot_basics.validate.errors import RoomFailure

_MARK = 'MY_ROBOT_BASICS_VALIDATE'
"""Names, in the environment of all that one of these has started, which one that was."""
_END_SEC = 5.0


class ForkServer:
    """A process that forks kernels; `with` ends it, and all that was left running in them."""

    def __init__(self) -> None:
        """Start it; it imports while other things are done."""
        self._mark = uuid.uuid4().hex
        self._asking = threading.Lock()
        self._process = subprocess.Popen(
            [sys.executable, '-P', '-m', 'my_robot_basics.validate.forkserver'],
            env=os.environ | {_MARK: self._mark},
            cwd='/',
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            text=True,
        )

    def __enter__(self) -> Self:
        """Nothing is left to do."""
        return self

    def __exit__(self, *_: object) -> None:
        """End it, and what students' code has forked and let go."""
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            self._process.communicate(timeout=_END_SEC)
        self._process.kill()
        self._process.wait()
        marked_processes.end(_MARK, self._mark)

    async def fork(
        self, folder: Path, environment: dict[str, str], arguments: list[str]
    ) -> 'ForkedKernel':
        """Fork a kernel that works in a folder. Raises RoomFailure."""
        order = {
            'folder': str(folder),
            'environment': environment | {_MARK: self._mark},
            'arguments': arguments,
        }
        try:
            return ForkedKernel(await asyncio.to_thread(self._ask, json.dumps(order)))
        except asyncio.CancelledError:
            self._process.kill()  # nobody knows what it would answer next
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
    """A kernel's process, with a session of its own."""

    def __init__(self, pid: int) -> None:
        """Take a process that was just forked."""
        self._pid = pid
        try:
            self._file = os.pidfd_open(pid)
        except ProcessLookupError:
            self._file = -1

    @property
    def alive(self) -> bool:
        """Whether it has not ended."""
        return self._file >= 0 and not select.select([self._file], [], [], 0)[0]

    def busy_sec(self) -> float:
        """For how long it has had a processor for its main thread, which runs the cells."""
        with contextlib.suppress(psutil.Error):
            threads = {thread.id: thread for thread in psutil.Process(self._pid).threads()}
            return threads[self._pid].user_time + threads[self._pid].system_time
        return 0.0

    def interrupt(self) -> None:
        """Interrupt what runs in it, and what it has started in its group."""
        self._send(signal.SIGINT)

    async def kill(self) -> None:
        """End it and its group, and wait for its own end."""
        self._send(signal.SIGKILL)
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self.ended(), _END_SEC)

    async def ended(self) -> None:
        """Wait for its end."""
        while self.alive:
            await asyncio.sleep(0.01)

    def close(self) -> None:
        """Forget it; to be called when it has ended."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _send(self, number: int) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._pid, number)
