"""The process that holds a sandbox's network and disks, and the processes in that network."""

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
    """A sandbox's holder: start() first; end() and close() last, whatever happens between."""

    def __init__(self, user: int | None, given: dict[str, Path]) -> None:
        """Prepare a holder for a slot's user; `given` has the folder that each room is shown."""
        self._user, self._given = user, given
        self._process: subprocess.Popen[bytes] | None = None
        self._network = -1
        self.pid = 0
        """The holder's process ID, as seen from outside the sandbox; set by start()."""

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
            silent = (
                'it did not answer'
                if ended is None
                else f'it ended with {ended}, without a message'
            )
            _kill(process)
            said = process.stderr.read(10_000).decode(errors='replace').strip()
            raise RoomFailure(f'the sandbox could not be made: {said or silent}')
        self.pid = int(line)
        self._network = os.open(f'/proc/{self.pid}/ns/net', os.O_RDONLY)

    def pids(self) -> Iterator[int]:
        """Yield the IDs of the processes that are in this sandbox's network namespace."""
        if self._network < 0:
            return
        ours = os.fstat(self._network)
        for name in os.listdir('/proc'):
            if name.isdigit():
                # other users' processes can't be read, and are not ours; others end while we look
                with contextlib.suppress(OSError):
                    if os.path.samestat(os.stat(f'/proc/{name}/ns/net'), ours):
                        yield int(name)

    async def end(self) -> None:
        """Kill the holder and all processes in its network; wait until they are gone."""
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
        """Close the network namespace, and forget the process."""
        if self._network >= 0:
            os.close(self._network)
        self._process, self._network = None, -1


def _kill(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
