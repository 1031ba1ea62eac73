"""How Jupyter starts a kernel in a sandbox: by the name of its kernelspec, or in a given room.

jupyter_client finds this class by its entry point, so nbclient, JupyterLab and nbgrader can run a
notebook in the kernel that is called NAME. The grader passes the paths of rooms that it opened.
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
"""If a signal ended its command, bubblewrap exits with the signal's number plus this."""
NAME = 'my_robot_basics_sandbox'
"""The name of the kernelspec, and of this provisioner's entry point."""


def socket_folder(paths: KernelPaths) -> Path:
    """Return the folder where a room's kernel creates its sockets."""
    assert paths.made is not None  # every sandboxed room has it
    return paths.made


class SandboxProvisioner(LocalProvisioner):
    """Runs one kernel in a room, forked from a preloaded process if this machine can do that."""

    why_not_forked = ''
    """Why the kernel was started, which is slower, and not forked; '' if it was forked."""
    signals: Signals | None = None
    """Signals that the room's processes send to each other."""
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
        """Prepare the room: the one with the given `paths`, or a new sandbox for this kernel.

        In a new sandbox, the kernel gets nothing of the caller's environment. Raises RoomFailure.
        """
        self._room, self._pins, manager = room, {}, self._manager
        if paths is None:
            paths = await self._open()
            assert self._claim is not None  # from _open
            kwargs['env'] = environment_of(paths, room=room, domain_id=self._claim.domain_id)
            manager.transport, manager.ip = 'ipc', str(paths.sockets / 'zmq')
        self._paths = paths
        kwargs = await super().pre_launch(**kwargs)
        for port in manager.ports:  # sockets of the earlier kernel, after a restart
            (socket_folder(paths) / f'zmq-{port}').unlink(missing_ok=True)
        paths.write_connection_file(Path(manager.connection_file))
        return kwargs | {'cmd': paths.command()}

    async def launch_kernel(self, cmd: list[str], **kwargs: Any) -> KernelConnectionInfo:
        """Fork the kernel, or else start it, in the same room and with the same rights."""
        try:
            forked = await fork_into(self._paths, room=self._room, environment=kwargs['env'])
        except NoForkedKernel as problem:
            self.why_not_forked = str(problem)
            return await self._started(kwargs['env'])
        # ForkedProcess has every method that jupyter_client calls
        self.process = forked  # type: ignore[assignment]
        self.pid, self.signals = forked.pid, forked.signals
        return self.connection_info

    async def ending(self) -> Ending:
        """Return how the kernel ended; call this once, after its end and before its cleanup."""
        if isinstance(self.process, ForkedProcess):
            return await self.process.ending()
        assert self.process is not None  # it was started
        status = self.process.returncode
        if status is None or status < 0 or self.signals is None:
            return Ending()  # the room's keeper was ended from outside the room
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
        """Link each connection to the socket that the kernel has created.

        Student code can write to the sockets' folder, and replace a socket by a link to a socket
        of the machine; so each socket is opened without following links. Raises RoomFailure.
        """
        await super().post_launch(**kwargs)
        names = [f'zmq-{port}' for port in self._manager.ports]
        async with asyncio.timeout(START_TIMEOUT_SEC):
            while not all((socket_folder(self._paths) / name).exists() for name in names):
                if await self.poll() is not None:
                    raise RoomFailure('its process ended')
                await asyncio.sleep(0.01)
        for name in names:
            pin = os.open(socket_folder(self._paths) / name, os.O_PATH | os.O_NOFOLLOW)
            self._pins[name] = pin
            (self._paths.sockets / name).symlink_to(f'/proc/self/fd/{pin}')

    async def cleanup(self, restart: bool = False) -> None:
        """Close the sandbox if it was opened for this kernel alone."""
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
        """Do nothing: the kernel's files are not on this machine's disk, so there is no path."""

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
