"""A kernel that was forked into a room, as the process that Jupyter looks after."""

import contextlib
import os
import select
import signal
import subprocess


class Forked:
    """A kernel that was forked into a room, as subprocess.Popen would be it."""

    stdin = stdout = stderr = None

    def __init__(self, room: subprocess.Popen, kernel: int) -> None:
        """Take the process that keeps the room, and a pidfd of the kernel; both end together."""
        self._room, self._kernel = room, kernel
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
        """End it, and all in its room."""
        self._room.kill()
        if self._kernel >= 0:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._kernel, signal.SIGKILL)

    def send_signal(self, number: int) -> None:
        """End it, whatever the signal: for an interrupt there are messages."""
        self.kill()

    terminate = kill


def _ended(process: int) -> bool:
    return bool(select.select([process], [], [], 0)[0])
