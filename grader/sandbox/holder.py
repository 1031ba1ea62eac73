"""The process that holds a sandbox's network and disks, and whatever else has that network."""

import asyncio
import contextlib
import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

from grader.common.errors import RoomFailure
from grader.sandbox.bubblewrap import holder_command

OPEN_TIMEOUT_SEC = 30.0


class Holder:
    """One such process: start() first; end() and close() last, whatever happens between."""

    def __init__(self, user: int | None, given: dict[str, Path]) -> None:
        """Prepare one for a slot's user; `given` names for each room the folder it is shown."""
        self._user, self._given = user, given
        self._process: subprocess.Popen[bytes] | None = None
        self._network = -1
        self.pid = 0
        """Its process ID as we know it; set by start()."""

    async def start(self) -> None:
        """Make the network and the disks. Raises RoomFailure."""
        self._process = process = subprocess.Popen(
            holder_command(self._user, self._given),
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            env={'PATH': f'{os.defpath}:/usr/sbin:/sbin'},
        )
        assert process.stdout is not None
        assert process.stderr is not None
        os.set_blocking(process.stdout.fileno(), False)
        line = b''
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(OPEN_TIMEOUT_SEC):
                while not line.endswith(b'\n') and process.poll() is None:
                    line += process.stdout.read(100) or b''
                    await asyncio.sleep(0.002)
        if not line.strip().isdigit():
            ended = process.poll()
            silent = 'it did not answer' if ended is None else f'it ended with {ended}, silently'
            _kill(process)
            said = process.stderr.read(10_000).decode(errors='replace').strip()
            raise RoomFailure(f'the sandbox could not be made: {said or silent}')
        self.pid = int(line)
        self._network = os.open(f'/proc/{self.pid}/ns/net', os.O_RDONLY)

    def pids(self) -> Iterator[int]:
        """Yield the processes that have this sandbox's network."""
        if self._network < 0:
            return
        ours = os.fstat(self._network)
        for name in os.listdir('/proc'):
            if name.isdigit():
                # other users' are not ours; others end while we look
                with contextlib.suppress(OSError):
                    if os.path.samestat(os.stat(f'/proc/{name}/ns/net'), ours):
                        yield int(name)

    async def end(self) -> None:
        """End it and all that has its network, and wait until they have gone."""
        if self._process is None:
            return
        _kill(self._process)
        while left := list(self.pids()):
            for pid in left:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            await asyncio.sleep(0.01)
        while self._process.poll() is None:
            await asyncio.sleep(0.005)
        for pipe in (self._process.stdin, self._process.stdout, self._process.stderr):
            if pipe is not None:
                pipe.close()

    def close(self) -> None:
        """Let go of the network; nothing is known of the process any more."""
        if self._network >= 0:
            os.close(self._network)
        self._process, self._network = None, -1


def _kill(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
