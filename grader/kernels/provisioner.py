"""How Jupyter starts a kernel in a sandbox: by the name of its kernelspec, or in a given room.

jupyter_client finds this class by its entry point, so nbclient, JupyterLab and nbgrader can run a
notebook in the kernel that is called NAME. The grader itself names the rooms that it has opened.
"""

import asyncio
import os
import socket
import sys
from pathlib import Path
from subprocess import DEVNULL
from typing import Any

from jupyter_client.connect import KernelConnectionInfo
from jupyter_client.provisioning import LocalProvisioner
from my_robot_basics.session.domain import Claim, claim

from grader.common.errors import RoomFailure
from grader.common.file_wait import readable
from grader.kernels.fork_client import fork_into
from grader.kernels.fork_servers import NoForkedKernel
from grader.kernels.forked_kernel import ForkedProcess
from grader.kernels.kernel_exits import Ending
from grader.sandbox.kernel_paths import KernelPaths, environment_of
from grader.sandbox.sandbox import Sandbox
from grader.sandbox.seccomp_notify import SHIM, signals_filter
from grader.sandbox.signals import Signals

START_TIMEOUT_SEC = 60.0
_SIGNALLED = 128
"""A signal's number and this is what bubblewrap exits with where a signal ended its command."""
NAME = 'my_robot_basics_sandbox'
"""Of the kernelspec, and of this provisioner's entry point."""


def made_in(paths: KernelPaths) -> Path:
    """Return where a room's kernel makes its sockets."""
    assert paths.made is not None  # every room says it
    return paths.made


class SandboxProvisioner(LocalProvisioner):
    """Runs one kernel in a room, forked from a preloaded process where this machine can."""

    why_not_forked = ''
    """Why the kernel was started the slow way, where it was."""
    signals: Signals | None = None
    """What the room's processes send each other."""
    _paths: KernelPaths
    _pins: dict[str, int]
    _room = 'student'
    _sandbox: Sandbox | None = None
    _claim: Claim | None = None

    @property
    def _manager(self) -> Any:
        """The kernel's manager, which made this provisioner."""
        return self.parent

    async def pre_launch(
        self, *, paths: KernelPaths | None = None, room: str = 'student', **kwargs: Any
    ) -> dict[str, Any]:
        """Prepare the room: with the given `paths`, or in a sandbox of this kernel's own.

        In one of its own a kernel is told nothing of the caller's environment. Raises RoomFailure.
        """
        self._room, self._pins, manager = room, {}, self._manager
        if paths is None:
            paths = await self._open()
            assert self._claim is not None  # from _open
            kwargs['env'] = environment_of(paths, room=room, domain_id=self._claim.domain_id)
            manager.transport, manager.ip = 'ipc', str(paths.sockets / 'zmq')
        self._paths = paths
        kwargs = await super().pre_launch(**kwargs)
        for port in manager.ports:  # of a former kernel, on a restart
            (made_in(paths) / f'zmq-{port}').unlink(missing_ok=True)
        paths.write_connection_file(Path(manager.connection_file))
        return kwargs | {'cmd': paths.command()}

    async def launch_kernel(self, cmd: list[str], **kwargs: Any) -> KernelConnectionInfo:
        """Fork the kernel, or start it: in the same room, and with no more rights."""
        try:
            forked = await fork_into(self._paths, room=self._room, environment=kwargs['env'])
        except NoForkedKernel as problem:
            self.why_not_forked = str(problem)
            return await self._started(kwargs['env'])
        # it has what jupyter_client asks of a process
        self.process = forked  # type: ignore[assignment]
        self.pid, self.signals = forked.pid, forked.signals
        return self.connection_info

    async def ending(self) -> Ending:
        """Return how the kernel ended; to be called once when it has, before its cleanup."""
        if isinstance(self.process, ForkedProcess):
            return await self.process.ending()
        assert self.process is not None  # it was started
        status = self.process.returncode
        if status is None or status < 0 or self.signals is None:
            return Ending()  # what ended the room's keeper was outside of it
        exited = status <= _SIGNALLED or status == self.signals.exit_code
        number = 0 if exited else status - _SIGNALLED
        return Ending(number, sent=self.signals.explain(number))

    async def _started(self, environment: dict[str, str]) -> KernelConnectionInfo:
        ours, theirs = socket.socketpair()
        with ours, theirs:
            python = [sys.executable, '-I', '-S', '-c', SHIM]
            shim = [*python, str(theirs.fileno()), signals_filter().hex()]
            info = await super().launch_kernel(
                [*self._paths.prefix, *shim, *self._paths.kernel_command()],
                env=environment,
                cwd='/',
                stdout=DEVNULL,
                stderr=DEVNULL,
                pass_fds=(*self._paths.pass_fds, theirs.fileno()),
            )
            theirs.close()
            async with asyncio.timeout(START_TIMEOUT_SEC):
                await readable(ours.fileno())
            _, files, _, _ = socket.recv_fds(ours, 10, 2)
            if files:
                self.signals = Signals(*files)
                os.close(files[0])
        return info

    async def post_launch(self, **kwargs: Any) -> None:
        """Let all connections lead to the sockets that the kernel makes now.

        Their folder is the student's, too, who may put links there to sockets of the machine.
        Raises RoomFailure.
        """
        await super().post_launch(**kwargs)
        names = [f'zmq-{port}' for port in self._manager.ports]
        async with asyncio.timeout(START_TIMEOUT_SEC):
            while not all((made_in(self._paths) / name).exists() for name in names):
                if await self.poll() is not None:
                    raise RoomFailure('its process ended')
                await asyncio.sleep(0.01)
        for name in names:
            pin = os.open(made_in(self._paths) / name, os.O_PATH | os.O_NOFOLLOW)
            self._pins[name] = pin
            (self._paths.sockets / name).symlink_to(f'/proc/self/fd/{pin}')

    async def cleanup(self, restart: bool = False) -> None:
        """Close the sandbox, if it is this kernel's own."""
        await super().cleanup(restart=restart)
        for name, pin in self._pins.items():
            (self._paths.sockets / name).unlink(missing_ok=True)
            os.close(pin)
        self._pins = {}
        if self.signals is not None:
            self.signals.close()
        if isinstance(self.process, ForkedProcess):
            self.process.close()
        if self._sandbox is not None and not restart:
            await self._close()

    def resolve_path(self, path_str: str) -> None:
        """Tell no path: the kernel's files are not on this machine's disk."""

    async def _open(self) -> KernelPaths:
        if self._sandbox is None:
            self._claim = claim()
            self._sandbox = Sandbox(slot=self._claim.domain_id)
            try:
                await self._sandbox.open()
            except BaseException:
                await self._close()
                raise
        return self._sandbox.paths('student')

    async def _close(self) -> None:
        assert self._sandbox is not None
        assert self._claim is not None
        try:
            await self._sandbox.close()
        finally:
            self._sandbox = None
            self._claim.release()
