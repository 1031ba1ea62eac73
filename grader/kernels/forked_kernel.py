"""A kernel that was forked into a room, as the process that Jupyter manages."""

import asyncio
import contextlib
import json
import os
import select
import signal
import socket
import subprocess

from grader.common.file_wait import readable
from grader.kernels.fork_servers import MAX_ANSWER
from grader.kernels.kernel_exits import Ending
from grader.sandbox.signals import Signals

_STATUS_SEC = 5.0
"""How long a kernel's parent may take to send the kernel's exit status."""


class ForkedProcess:
    """A kernel that was forked into a room, with the interface of subprocess.Popen."""

    stdin = stdout = stderr = None

    def __init__(
        self, room: subprocess.Popen, kernel: int, listener: int, connection: socket.socket
    ) -> None:
        """Take the process that keeps the room, and a pidfd of the kernel; both end together.

        The kernel's parent sends the kernel's exit status over `connection`. `listener` is the
        file where Linux reports signals that are sent in the room, or -1.
        """
        self._room, self._kernel, self._connection = room, kernel, connection
        self.signals = Signals(kernel, listener)
        self.pid = room.pid

    def poll(self) -> int | None:
        """Return None while it runs."""
        if self._kernel >= 0:
            if not _ended(self._kernel) and self._room.poll() is None:
                return None
            self.kill()
            if not _ended(self._kernel):
                return None
            os.close(self._kernel)
            self._kernel = -1
        return self._room.poll()

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end. Raises subprocess.TimeoutExpired after `timeout` seconds."""
        if self._kernel >= 0:
            select.select([self._kernel], [], [], timeout)
            self.poll()
        return self._room.wait(timeout)

    def kill(self) -> None:
        """End the kernel and everything in its room."""
        self._room.kill()
        if self._kernel >= 0:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._kernel, signal.SIGKILL)

    async def ending(self) -> Ending:
        """Return how the kernel ended; call this once, after it has ended."""
        try:
            async with asyncio.timeout(_STATUS_SEC):
                await readable(self._connection.fileno())
            status, cpu_sec = json.loads(self._connection.recv(MAX_ANSWER))
        except (TimeoutError, OSError, ValueError):  # the parent was killed, too
            return Ending()
        number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        return Ending(number, sent=self.signals.explain(number), cpu_sec=cpu_sec)

    def close(self) -> None:
        """Close all files that belong to it, whether it has ended or not."""
        self.signals.close()
        self._connection.close()

    def send_signal(self, number: int) -> None:
        """End the kernel, whatever the signal: Jupyter interrupts it by a message."""
        self.kill()

    terminate = kill


def _ended(process: int) -> bool:
    return bool(select.select([process], [], [], 0)[0])
