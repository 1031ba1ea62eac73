"""The student kernel and the test kernel: start one, run a cell in it, stop it."""

import asyncio
import contextlib
import queue
import time
from pathlib import Path
from subprocess import DEVNULL
from typing import cast

import psutil
import zmq.asyncio
from jupyter_client import AsyncKernelClient, AsyncKernelManager
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.provisioning import LocalProvisioner
from my_robot_basics.validate.limits import MAX_MESSAGE_BYTES, MAX_MESSAGES_WAITING
from my_robot_basics.validate.messages import Messages, OnInput, unpacked
from my_robot_basics.validate.outputs import CellRun
from my_robot_basics.validate.timeouts import finished, finished_in_grace

from grader.common.errors import RoomFailure
from grader.kernels.kernel_exits import Ending, is_from_outside
from grader.kernels.provisioner import NAME, SandboxProvisioner
from grader.sandbox.kernel_paths import Place, environment_of, open_place
from grader.sandbox.signals import killed_processes

START_TIMEOUT_SEC = 60.0
STOP_GRACE_SEC = 2.0
_END_SEC = 1.0
"""A process whose sockets are closed is gone after so long, if it is ending."""


class _OurKernelSpec(KernelSpecManager):
    """One kernel, the interpreter we run on: no kernelspec of a student is ever looked up."""

    argv: tuple[str, ...] = ()
    metadata: dict = {}

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        return KernelSpec(
            argv=list(self.argv),
            display_name='my_robot_basics',
            language='python',
            interrupt_mode='message',  # a signal from outside would end a sandbox
            metadata=self.metadata,
        )


class Kernel:
    """One kernel in an empty folder of its own; everything of it goes with stop()."""

    def __init__(
        self, *, room: str, domain_id: int, seed: str = '', place: Place | None = None
    ) -> None:
        """Prepare a kernel of the 'student' or the 'test' room in a ROS domain.

        It lives in `place`, or else has the grading user's rights.
        """
        self.room = room
        self.place = place or open_place(room)
        self._environment = environment_of(self.place, room=room, domain_id=domain_id, seed=seed)
        self._context = zmq.asyncio.Context()
        self._context.setsockopt(zmq.MAXMSGSIZE, MAX_MESSAGE_BYTES)
        self._context.setsockopt(zmq.RCVHWM, MAX_MESSAGES_WAITING)
        specs = _OurKernelSpec()
        specs.argv = tuple(self.place.command())
        if self.place.closed:
            specs.metadata = {'kernel_provisioner': {'provisioner_name': NAME}}
        self._manager = AsyncKernelManager(
            context=self._context,
            kernel_spec_manager=specs,
            transport='ipc',
            ip=str(self.place.sockets / 'zmq'),
            connection_file=str(self.place.folder / 'connection.json'),
        )
        self._client: AsyncKernelClient | None = None
        self._monitors: list[zmq.asyncio.Socket] = []
        self._ending: Ending | None = None
        self._ended_by_us = False
        self.alive = False

    @property
    def folder(self) -> Path:
        """The grader's folder for this kernel."""
        return self.place.folder

    @property
    def why_not_warm(self) -> str:
        """Why a kernel in a sandbox was started and not forked; '' where it was."""
        return self._in_sandbox().why_not_warm

    async def start(self) -> 'Kernel':
        """Start the kernel and wait until its outputs are received; raises RoomFailure."""
        try:
            await self._launch()
            async with asyncio.timeout(START_TIMEOUT_SEC):
                await self._connect()
        except Exception as error:
            await self.stop()
            why = str(error) or type(error).__name__
            raise RoomFailure(f'the {self.room} kernel did not start: {why}') from error
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
        """Run one cell; interrupt it after `timeout_sec`, kill the kernel if that does nothing.

        A cell that floods its outputs counts as timed out at once.
        """
        result = CellRun()
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
                done, timeout_sec, self._is_alive, lambda: result.flooded or self._is_cut_off
            )
            if result.timed_out and self._is_cut_off:
                result.timed_out = result.cut_off = await self._lives_on()
                if result.cut_off:
                    self._ended_by_us = True
                    await self._kill()
            elif result.timed_out and self.alive:
                await self._manager.interrupt_kernel()
                if not await finished_in_grace(done, self._is_alive):
                    self._ended_by_us = self.alive
                    await self._kill()
        finally:
            done.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await done
        result.died = not self.alive
        result.close()
        return result

    async def ending(self) -> Ending | None:
        """Look whether the kernel has ended, and return how; None where it lives, or we ended it.

        If it has the grading user's rights, nobody knows who sent a signal.
        """
        if self._ending is None and not self._ended_by_us and not await self._is_alive():
            if self.place.closed:
                self._ending = await self._in_sandbox().ending()
            else:
                provisioner = cast(LocalProvisioner, self._manager.provisioner)
                assert provisioner.process is not None  # it was started
                self._ending = Ending(max(0, -(provisioner.process.returncode or 0)))
        return self._ending

    def strangers_signal(self) -> int:
        """Return what signal from outside ended a process that the kernel started, or 0.

        They are known while nobody in the room has asked how they ended.
        """
        signals = self._in_sandbox().signals if self.place.closed and self.alive else None
        if signals is None:
            return 0
        for number, ids in killed_processes(signals.pid):
            if signals.known and is_from_outside(number) and not signals.explain(number, ids):
                return number
        return 0

    async def stop(self, *, politely: bool = True) -> None:
        """End the kernel and its folder; politely first where nodes of its hold shared memory."""
        if politely and self.alive and self._manager.has_kernel:
            assert self._client is not None  # it is alive
            self._client.shutdown()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._exited(), STOP_GRACE_SEC)
        await self._kill()
        if self._client is not None:
            self._client.stop_channels()
        self._context.destroy(linger=0)
        self.place.remove()

    def _in_sandbox(self) -> SandboxProvisioner:
        """Return what runs the kernel of a closed place: its kernelspec names that."""
        return cast(SandboxProvisioner, self._manager.provisioner)

    async def _launch(self) -> None:
        if self.place.closed:
            await self._manager.start_kernel(
                place=self.place, room=self.room, env=self._environment
            )
            return
        self._manager.write_connection_file()
        self.place.tell(Path(self._manager.connection_file))
        await self._manager.start_kernel(
            cwd=self.place.folder / 'home' / 'work',
            env=self._environment,
            stdout=DEVNULL,
            stderr=DEVNULL,
        )

    async def _connect(self) -> None:
        """Wait until the kernel's sockets are there, and until it knows that we listen.

        jupyter_client's wait_for_ready asks and flushes by fractions of a second; a kernel says
        itself when it has taken a subscription, and what it is sent earlier waits in its queue.
        """
        while not Path(f'{self._manager.ip}-{self._manager.iopub_port}').exists():
            await self._expect_alive()
            await asyncio.sleep(0.01)
        self._client = client = self._manager.client(context=self._context)
        client.session.unpack = unpacked
        client.start_channels(hb=False)
        self._messages = Messages(client)
        for channel in (client.iopub_channel, client.shell_channel):
            self._monitors.append(channel.socket.get_monitor_socket(zmq.EVENT_DISCONNECTED))
        kind = None
        while kind != 'iopub_welcome':
            await self._expect_alive()
            with contextlib.suppress(queue.Empty):
                kind = (await client.get_iopub_msg(timeout=0.5))['msg_type']

    @property
    def _is_cut_off(self) -> bool:
        """Whether a connection has ended: by the kernel's end, by its doing, or by a message.

        ZMQ ends one whose message is larger than MAX_MESSAGE_BYTES; nothing comes on it any more.
        """
        return any(cast(int, monitor.get(zmq.EVENTS)) & zmq.POLLIN for monitor in self._monitors)

    async def _lives_on(self) -> bool:
        """Whether the kernel did not end with its connection; what ends takes a moment for it."""
        moment = asyncio.ensure_future(asyncio.sleep(_END_SEC))
        try:
            await finished(moment, _END_SEC, self._is_alive)
        finally:
            moment.cancel()
        return self.alive

    async def _expect_alive(self) -> None:
        if not await self._manager.is_alive():
            raise RoomFailure('its process ended')

    async def _kill(self) -> None:
        """Kill the kernel's process group, and what left the group but kept its environment."""
        self.alive = False
        provisioner = self._manager.provisioner
        if self._manager.has_kernel and provisioner is not None:
            await provisioner.kill()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._exited(), STOP_GRACE_SEC)
                # else it would be sent an interrupt, and that be waited for
                await provisioner.wait()
            await self._manager.shutdown_kernel(now=True)
        deadline = time.monotonic() + STOP_GRACE_SEC
        while (
            not self.place.closed and (left := self._leftovers()) and time.monotonic() < deadline
        ):
            for process in left:
                with contextlib.suppress(psutil.Error):
                    process.kill()
            await asyncio.sleep(0.02)

    def _leftovers(self) -> list[psutil.Process]:
        left = []
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                if process.environ().get('IPYTHONDIR') == self._environment['IPYTHONDIR']:
                    left.append(process)
        return left

    async def _exited(self) -> None:
        while await self._manager.is_alive():
            await asyncio.sleep(0.01)

    async def _is_alive(self) -> bool:
        self.alive = await self._manager.is_alive()
        return self.alive
