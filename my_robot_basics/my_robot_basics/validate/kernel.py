"""One kernel on the student's own machine, with the student's own rights."""

import asyncio
import contextlib
import math
import os
import queue
import signal
import sys
from pathlib import Path
from subprocess import DEVNULL

import psutil
from jupyter_client import AsyncKernelClient, AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager

from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.messages import Messages, OnInput
from my_robot_basics.validate.outputs import CellRun
from my_robot_basics.validate.timeouts import finished, finished_in_grace

START_TIMEOUT_SEC = 60.0
STOP_GRACE_SEC = 2.0


class _ThisPython(KernelSpecManager):
    """One kernel, of the interpreter we run on: whatever the user has installed."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        launcher = [sys.executable, '-m', 'ipykernel_launcher', '-f', '{connection_file}']
        options = ['--InteractiveShellApp.ignore_cwd=True', '--HistoryManager.enabled=False']
        return KernelSpec(
            argv=[*launcher, *options], display_name='my_robot_basics', language='python'
        )


class Kernel:
    """One kernel that works in a folder of its own; everything of it goes with stop()."""

    def __init__(self, folder: Path, environment: dict[str, str]) -> None:
        """Prepare a kernel in an empty folder; `environment` is added to the caller's."""
        self._work = folder / 'work'
        self._work.mkdir(parents=True)
        self._environment = os.environ | environment | {'IPYTHONDIR': str(folder / 'ipython')}
        self._manager = AsyncKernelManager(
            kernel_spec_manager=_ThisPython(),
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
                await self._manager.start_kernel(
                    cwd=self._work, env=self._environment, stdout=DEVNULL, stderr=DEVNULL
                )
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
        """Run one cell; interrupt it after `timeout_sec`, kill the kernel if that does nothing.

        So it does after `free_sec` in which no process had to wait for a processor.
        """
        result, watch = CellRun(), Stopwatch()
        if not self.alive:
            result.died = True
            return result
        assert self._client is not None  # it is alive
        request = self._client.execute(
            code,
            store_history=False,
            user_expressions=expressions,
            allow_stdin=on_input is not None,
            stop_on_error=False,
        )
        done = asyncio.ensure_future(self._messages.follow(request, result, on_input))
        try:
            result.timed_out = not await finished(
                done,
                timeout_sec,
                self._is_alive,
                lambda: result.flooded or watch.free_sec() >= free_sec,
            )
            if result.timed_out and not result.flooded and free_sec < math.inf:
                result.cut_after_sec = watch.wall_sec()
            if result.timed_out and self.alive:
                await self._manager.interrupt_kernel()
                if not await finished_in_grace(done, self._is_alive):
                    await self._kill()
        finally:
            done.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await done
        result.died = not self.alive
        result.close()
        return result

    async def stop(self, *, politely: bool) -> None:
        """End the kernel and all that it started; politely first where it may have nodes."""
        if politely and self.alive:
            assert self._client is not None  # it is alive
            self._client.shutdown()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._exited(), STOP_GRACE_SEC)
        await self._kill()
        if self._client is not None:
            self._client.stop_channels()

    async def _connect(self) -> None:
        """Wait until the kernel says that it has taken our subscription to its outputs."""
        self._client = client = self._manager.client()
        client.start_channels(hb=False)
        self._messages = Messages(client)
        kind = None
        while kind != 'iopub_welcome':
            if not await self._manager.is_alive():
                raise RoomFailure('a kernel did not start: its process ended')
            with contextlib.suppress(queue.Empty):
                kind = (await client.get_iopub_msg(timeout=0.5))['msg_type']

    async def _kill(self) -> None:
        """Kill the kernel, and what left its process group but kept its environment."""
        self.alive = False
        if self._manager.has_kernel:
            await self._manager.shutdown_kernel(now=True)
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                if process.environ().get('IPYTHONDIR') == self._environment['IPYTHONDIR']:
                    process.send_signal(signal.SIGKILL)

    async def _exited(self) -> None:
        while await self._manager.is_alive():
            await asyncio.sleep(0.01)

    async def _is_alive(self) -> bool:
        self.alive = await self._manager.is_alive()
        return self.alive
