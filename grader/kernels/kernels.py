"""The student kernel and the test kernel: start one, run a cell in it, stop it."""

import asyncio
import contextlib
from pathlib import Path
from typing import cast

from jupyter_client.provisioning import LocalProvisioner
from my_robot_basics.validate.kernels.messages import OnInput
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.timeouts import (
    UsedSec,
    wait_for_end,
    wait_for_end_by_cpu_time,
    wait_for_end_in_grace,
)

from grader.common.errors import RoomFailure
from grader.kernels.kernel_connection import KernelConnection
from grader.kernels.kernel_exits import Ending, is_from_outside
from grader.kernels.kernel_manager import launch, manager_of
from grader.kernels.leftovers import kill_leftovers
from grader.kernels.provisioner import SandboxProvisioner
from grader.sandbox.kernel_paths import KernelPaths, environment_of, make_paths
from grader.sandbox.signals import killed_processes

START_TIMEOUT_SEC = 60.0
STOP_GRACE_SEC = 2.0
_END_SEC = 1.0
"""How long a kernel that closed its sockets may take to end."""


class GradingKernel:
    """One kernel in an empty folder of its own; stop() ends it and removes the folder."""

    def __init__(
        self, *, room: str, domain_id: int, seed: str = '', paths: KernelPaths | None = None
    ) -> None:
        """Prepare a kernel of the 'student' or the 'test' room in a ROS domain.

        It runs in the sandbox of `paths`; without `paths`, it has the grading user's rights.
        """
        self.room = room
        self.paths = paths or make_paths(room)
        self._environment = environment_of(self.paths, room=room, domain_id=domain_id, seed=seed)
        self._connection = KernelConnection()
        self._manager = manager_of(self.paths, self._connection.context)
        self._ending: Ending | None = None
        self._ended_by_us = False
        self.alive = False

    @property
    def folder(self) -> Path:
        """The grader's folder for this kernel."""
        return self.paths.folder

    @property
    def why_not_forked(self) -> str:
        """Why a kernel in a sandbox was started and not forked; '' if it was forked."""
        return self._in_sandbox().why_not_forked

    async def start(self) -> 'GradingKernel':
        """Start the kernel and wait until its outputs can be received. Raises RoomFailure."""
        try:
            await launch(self._manager, self.paths, self.room, self._environment)
            async with asyncio.timeout(START_TIMEOUT_SEC):
                await self._connection.connect(self._manager)
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
        used_sec: UsedSec = lambda: None,
    ) -> CellRun:
        """Run one cell; interrupt it after `timeout_sec`, kill the kernel if that has no effect.

        A cell that floods its outputs counts as timed out at once. A cell that got too little
        processor time gets longer: `used_sec` returns how much its room has used, in s.
        """
        result = CellRun()
        if not self.alive:
            result.died = True
            return result
        connection = self._connection
        cell = connection.messages.run(code, result, on_input=on_input, expressions=expressions)
        async with cell as done:
            result.timed_out = not await wait_for_end_by_cpu_time(
                done,
                timeout_sec,
                self._is_alive,
                lambda: result.flooded or connection.is_cut_off,
                used_sec,
            )
            if result.timed_out and connection.is_cut_off:
                result.timed_out = result.cut_off = await self._still_runs()
                if result.cut_off:
                    self._ended_by_us = True
                    await self._kill()
            elif result.timed_out and self.alive:
                await self._manager.interrupt_kernel()
                if not await wait_for_end_in_grace(done, self._is_alive):
                    self._ended_by_us = self.alive
                    await self._kill()
        if result.leaves:
            self._ended_by_us = True
            await self._kill()
        result.died = not self.alive
        result.close()
        return result

    async def ending(self) -> Ending | None:
        """Return how the kernel ended; None if it is running, or if we ended it.

        Without a sandbox, it is not known which process sent a signal.
        """
        if self._ending is None and not self._ended_by_us and not await self._is_alive():
            if self.paths.sandboxed:
                self._ending = await self._in_sandbox().ending()
            else:
                provisioner = cast(LocalProvisioner, self._manager.provisioner)
                assert provisioner.process is not None  # it was started
                self._ending = Ending(max(0, -(provisioner.process.returncode or 0)))
        return self._ending

    def foreign_signal(self) -> int:
        """Return the signal from outside that ended a process which the kernel started, or 0.

        Such a process is found only until a process in the room has waited for it.
        """
        signals = self._in_sandbox().signals if self.paths.sandboxed and self.alive else None
        if signals is None:
            return 0
        for number, ids in killed_processes(signals.pid):
            if signals.known and is_from_outside(number) and not signals.explain(number, ids):
                return number
        return 0

    async def stop(self, *, politely: bool = True) -> None:
        """End the kernel and remove its folder; `politely`, its nodes first free shared memory."""
        if politely and self.alive and self._manager.has_kernel:
            self._connection.client.shutdown()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._exited(), STOP_GRACE_SEC)
        await self._kill()
        self._connection.close()
        self.paths.remove()

    def _in_sandbox(self) -> SandboxProvisioner:
        """Return the provisioner of a sandboxed kernel: its kernelspec names this class."""
        return cast(SandboxProvisioner, self._manager.provisioner)

    async def _still_runs(self) -> bool:
        """Whether the kernel still runs; wait first, because it may be about to end."""
        moment = asyncio.ensure_future(asyncio.sleep(_END_SEC))
        try:
            await wait_for_end(moment, _END_SEC, self._is_alive)
        finally:
            moment.cancel()
        return self.alive

    async def _kill(self) -> None:
        """Kill the kernel's process group, and processes that left it but kept its environment."""
        self.alive = False
        provisioner = self._manager.provisioner
        if self._manager.has_kernel and provisioner is not None:
            await provisioner.kill()
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(self._exited(), STOP_GRACE_SEC)
                # or shutdown_kernel would send an interrupt, and wait for the effect
                await provisioner.wait()
            await self._manager.shutdown_kernel(now=True)
        if not self.paths.sandboxed:
            folder = self._environment['IPYTHONDIR']
            await kill_leftovers(folder, timeout_sec=STOP_GRACE_SEC)

    async def _exited(self) -> None:
        while await self._manager.is_alive():
            await asyncio.sleep(0.01)

    async def _is_alive(self) -> bool:
        self.alive = await self._manager.is_alive()
        return self.alive
