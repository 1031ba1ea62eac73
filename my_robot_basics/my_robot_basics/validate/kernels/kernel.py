"""One kernel on the student's own machine, with the student's own rights."""

import asyncio
import contextlib
import math
import os
import signal
from pathlib import Path

import psutil
from jupyter_client import AsyncKernelClient, AsyncKernelManager

from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.connecting import wait_for_sockets, wait_for_welcome
from my_robot_basics.validate.kernels.forks import ForkedKernel, ForkServer
from my_robot_basics.validate.kernels.messages import Messages, OnInput
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.timeouts import wait_for_end, wait_for_end_in_grace

START_TIMEOUT_SEC = 60.0
STOP_GRACE_SEC = 2.0
OPTIONS = ('--InteractiveShellApp.ignore_cwd=True', '--HistoryManager.enabled=False')


class LocalKernel:
    """One kernel with its own working directory; `stop` ends all that it has started."""

    def __init__(self, folder: Path, environment: dict[str, str], server: ForkServer) -> None:
        """Prepare a kernel in an empty folder; `environment` is added to the caller's."""
        self._server = server
        self._process: ForkedKernel | None = None
        self._work = folder / 'work'
        self._work.mkdir(parents=True)
        self._environment = os.environ | environment | {'IPYTHONDIR': str(folder / 'ipython')}
        self._manager = AsyncKernelManager(
            transport='ipc',
            ip=str(folder / 'zmq'),
            connection_file=str(folder / 'connection.json'),
        )
        self._client: AsyncKernelClient | None = None
        self.alive = False

    async def start(self) -> None:
        """Start the kernel and wait until its outputs are received. Raises RoomFailure."""
        try:
            async with asyncio.timeout(START_TIMEOUT_SEC):
                self._manager.write_connection_file()
                options = ['-f', self._manager.connection_file, *OPTIONS]
                self._process = await self._server.fork(self._work, self._environment, options)
                await self._connect()
        except (OSError, RuntimeError, TimeoutError) as error:
            raise RoomFailure(f'a kernel did not start: {error or "it took too long"}') from error
        self.alive = True

    async def run(
        self,
        code: str,
        *,
        timeout_sec: float,
        free_sec: float = math.inf,
        on_input: OnInput | None = None,
        expressions: dict[str, str] | None = None,
    ) -> CellRun:
        """Run one cell; interrupt it after `timeout_sec`, kill the kernel if that does not help.

        The same happens after `free_sec` in which no process had to wait for a processor, or
        after `free_sec` of processor time of the code itself.
        """
        result, watch = CellRun(), Stopwatch()
        if not self.alive:
            result.died = True
            return result
        busy_sec = self._forked.busy_sec()

        def is_enough() -> bool:
            free_for_sec = max(watch.free_sec(), self._forked.busy_sec() - busy_sec)
            return result.flooded or free_for_sec >= free_sec

        cell = self._messages.run(code, result, on_input=on_input, expressions=expressions)
        async with cell as done:
            result.timed_out = not await wait_for_end(done, timeout_sec, self._is_alive, is_enough)
            if result.timed_out and not result.flooded and free_sec < math.inf:
                result.cut_after_sec = watch.wall_sec()
            if result.timed_out and self.alive:
                self._forked.interrupt()
                if not await wait_for_end_in_grace(done, self._is_alive):
                    await self._kill()
        if result.leaves:
            await self._kill()
        result.died = not self.alive
        result.close()
        return result

    async def stop(self, *, politely: bool) -> None:
        """End the kernel and all that it started; with `politely`, ask it to shut down first.

        That lets it destroy its nodes.
        """
        if politely and self.alive:
            assert self._client is not None  # it is alive
            self._client.shutdown()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._forked.ended(), STOP_GRACE_SEC)
        await self._kill()
        if self._client is not None:
            self._client.stop_channels()

    @property
    def _forked(self) -> ForkedKernel:
        """The kernel's process, once it was started."""
        assert self._process is not None
        return self._process

    async def _connect(self) -> None:
        await wait_for_sockets(self._manager, self._expect_alive)
        self._client = client = self._manager.client()
        client.start_channels(hb=False)
        self._messages = Messages(client)
        await wait_for_welcome(client, self._expect_alive)

    async def _kill(self) -> None:
        """Kill the kernel, and processes that left its group but have its IPYTHONDIR."""
        self.alive = False
        if self._process is not None:
            await self._process.kill()
            self._process.close()
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                if process.environ().get('IPYTHONDIR') == self._environment['IPYTHONDIR']:
                    process.send_signal(signal.SIGKILL)

    async def _expect_alive(self) -> None:
        if not self._forked.alive:
            raise RoomFailure('a kernel did not start: its process ended')

    async def _is_alive(self) -> bool:
        self.alive = self._forked.alive
        return self.alive
