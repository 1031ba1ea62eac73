"""The student kernel and the test kernel: start one, run a cell in it, stop it."""

import asyncio
import contextlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from subprocess import DEVNULL

from jupyter_client import AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager

from grader.errors import RoomFailure
from grader.outputs import CellRun, Displays

START_TIMEOUT_SEC = 60.0
INTERRUPT_GRACE_SEC = 2.0
STOP_GRACE_SEC = 2.0

OnInput = Callable[[str], Awaitable[str]]
"""Answers a kernel's input() request."""


class _OurKernelSpec(KernelSpecManager):
    """One kernel, the interpreter we run on: no kernelspec of a student is ever looked up."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        return KernelSpec(
            argv=[
                sys.executable,
                '-m',
                'ipykernel_launcher',
                '-f',
                '{connection_file}',
                '--InteractiveShellApp.ignore_cwd=True',
                '--HistoryManager.enabled=False',
            ],
            display_name='my_robot_basics',
            language='python',
        )


class Kernel:
    """One kernel in an empty folder of its own; everything of it goes with stop()."""

    def __init__(self, *, room: str, domain_id: int, seed: str = '') -> None:
        """Prepare a kernel of the 'student' or the 'test' room in a ROS domain."""
        self.room = room
        self.folder = Path(tempfile.mkdtemp(prefix='mrb-', dir=_temporary_folder()))
        self._environment = _environment(room, domain_id, seed, self.folder)
        self._manager = AsyncKernelManager(
            kernel_spec_manager=_OurKernelSpec(),
            transport='ipc',
            ip=str(self.folder / 'zmq'),
            connection_file=str(self.folder / 'connection.json'),
        )
        self._client = None
        self._displays = Displays()
        self.alive = False

    async def start(self) -> 'Kernel':
        """Start the kernel and wait until it answers; raises RoomFailure."""
        work = self.folder / 'work'
        work.mkdir()
        try:
            await self._manager.start_kernel(
                cwd=str(work), env=self._environment, stdout=DEVNULL, stderr=DEVNULL
            )
            self._client = self._manager.client()
            self._client.start_channels(hb=False)
            await self._client.wait_for_ready(timeout=START_TIMEOUT_SEC)
        except Exception as error:
            await self.stop()
            raise RoomFailure(f'the {self.room} kernel did not start: {error}') from error
        self.alive = True
        return self

    async def run(
        self,
        code: str,
        *,
        timeout_sec: float,
        on_input: OnInput | None = None,
        expressions: dict[str, str] | None = None,
    ) -> CellRun:
        """Run one cell; interrupt it after `timeout_sec`, kill the kernel if that does nothing."""
        result = CellRun()
        if not self.alive:
            result.died = True
            return result
        request = self._client.execute(
            code,
            store_history=False,
            user_expressions=expressions,
            allow_stdin=on_input is not None,
            stop_on_error=False,
        )
        done = asyncio.ensure_future(self._collect(request, result, on_input))
        try:
            result.timed_out = not await self._finished(done, timeout_sec)
            if result.timed_out and self.alive:
                await self._manager.interrupt_kernel()
                if not await self._finished(done, INTERRUPT_GRACE_SEC):
                    await self._kill()
        finally:
            if not done.done():
                done.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await done
        result.died = not self.alive
        result.close()
        return result

    async def stop(self) -> None:
        """End the kernel, politely first so that its DDS resources go too, and its folder."""
        if self._manager.has_kernel:
            with contextlib.suppress(Exception):
                if self.alive:
                    self._client.shutdown()
                    await asyncio.wait_for(self._exited(), STOP_GRACE_SEC)
            await self._kill()
        if self._client is not None:
            self._client.stop_channels()
        shutil.rmtree(self.folder, ignore_errors=True)
        self.alive = False

    async def _kill(self) -> None:
        self.alive = False
        if self._manager.has_kernel:
            await self._manager.shutdown_kernel(now=True)

    async def _exited(self) -> None:
        while await self._manager.is_alive():
            await asyncio.sleep(0.01)

    async def _finished(self, done: asyncio.Future, timeout_sec: float) -> bool:
        """Wait for a cell's end, its time limit, or the kernel's death."""
        deadline = time.monotonic() + timeout_sec
        while not done.done():
            remaining = deadline - time.monotonic()
            if remaining <= 0:
                return False
            await asyncio.wait([done], timeout=min(0.2, remaining))
            if not done.done() and not await self._manager.is_alive():
                await asyncio.wait([done], timeout=0.2)  # what it said last may be under way
                self.alive = False
                return True
        await done
        return True

    async def _collect(self, request: str, result: CellRun, on_input: OnInput | None) -> None:
        """Gather a cell's outputs until the kernel is idle again, and its reply."""
        answering = asyncio.ensure_future(self._answer_inputs(request, on_input))
        try:
            while True:
                message = await self._client.get_iopub_msg(timeout=None)
                kind, content = message['msg_type'], message['content']
                if kind == 'update_display_data':
                    self._displays.update(message)
                if message['parent_header'].get('msg_id') != request:
                    continue
                if kind == 'status' and content['execution_state'] == 'idle':
                    break
                self._displays.remember(message, result.keep(message))
            while True:
                reply = await self._client.get_shell_msg(timeout=None)
                if reply['parent_header'].get('msg_id') == request:
                    result.expressions = reply['content'].get('user_expressions', {})
                    return
        finally:
            answering.cancel()

    async def _answer_inputs(self, request: str, on_input: OnInput | None) -> None:
        while on_input is not None:
            message = await self._client.get_stdin_msg(timeout=None)
            if message['parent_header'].get('msg_id') == request:
                self._client.input(await on_input(message['content']['prompt']))


def _environment(room: str, domain_id: int, seed: str, folder: Path) -> dict[str, str]:
    """What a kernel's process is told: nothing of the caller's own, but where things are."""
    passed_on = ('PATH', 'HOME', 'LANG', 'LC_ALL', 'TMPDIR', 'AMENT_PREFIX_PATH', 'TZ')
    environment = {name: os.environ[name] for name in passed_on if name in os.environ}
    environment |= {
        'MY_ROBOT_BASICS_ROOM': room,
        'MY_ROBOT_BASICS_DOMAIN_ID': str(domain_id),
        'RCUTILS_LOGGING_USE_STDOUT': '1',
        'ROS_LOG_DIR': str(folder / 'ros_log'),
        'IPYTHONDIR': str(folder / 'ipython'),
        'MPLBACKEND': 'module://matplotlib_inline.backend_inline',
        'PYTHONSAFEPATH': '1',
        'PYTHONDONTWRITEBYTECODE': '1',
    }
    if room == 'test':
        environment['MY_ROBOT_BASICS_SEED'] = seed
    return environment


def _temporary_folder() -> str | None:
    """Where a kernel's folder goes: a Unix socket's path holds 107 characters at most."""
    return '/tmp' if len(tempfile.gettempdir()) > 60 else None
