"""Fork a kernel into a room: build the room, send the order for it, and wait for the answer.

The order goes over a connection that a fork server has passed on to a process it has forked.
"""

import asyncio
import contextlib
import json
import os
import socket
import subprocess

from grader.common.errors import RoomFailure
from grader.common.file_wait import readable
from grader.kernels.fork_servers import MAX_ANSWER, RoomForkServer, require_forkable, send
from grader.kernels.forked_kernel import ForkedProcess
from grader.sandbox.kernel_paths import Keeper, KernelPaths
from grader.sandbox.limits import OUT_OF_MEMORY_SCORE, process_limits
from grader.sandbox.seccomp import seccomp_filter
from grader.sandbox.seccomp_notify import signals_filter

_TIMEOUT_SEC = 60.0
_NAMESPACES = ('user', 'mnt', 'net', 'pid', 'ipc', 'uts', 'cgroup')


async def fork_into(
    paths: KernelPaths, *, room: str, environment: dict[str, str]
) -> ForkedProcess:
    """Build a room, and fork a kernel into it; `room` is its kind, 'student' or 'test'.

    Raises NoForkedKernel if kernels can't be forked, and RoomFailure if the room can't be built.
    """
    require_forkable(room)
    ordered = keeper_of(paths)
    keeper = subprocess.Popen(
        ordered.command,
        bufsize=0,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        pass_fds=ordered.pass_fds,
        env={'PATH': f'{os.defpath}:/usr/sbin:/sbin'},
    )
    try:
        async with asyncio.timeout(_TIMEOUT_SEC):
            first = await _built(keeper, ordered.info_fd)
            return ForkedProcess(keeper, *await _forked(paths, room, environment, first))
    except BaseException:
        keeper.kill()
        keeper.wait()
        raise
    finally:
        assert keeper.stdout is not None  # it is a pipe
        keeper.stdout.close()


def keeper_of(paths: KernelPaths) -> Keeper:
    """Return the keeper of a sandboxed room: kernels are forked into sandboxed rooms only."""
    assert paths.keeper is not None
    return paths.keeper


async def _built(keeper: subprocess.Popen, info_fd: int) -> int:
    """Wait until a room is built; return the process ID of its first process."""
    assert keeper.stdout is not None  # it is a pipe
    await readable(keeper.stdout.fileno())
    said = keeper.stdout.read(MAX_ANSWER)
    if said != b'\n':
        raise RoomFailure(f'the room could not be built: {said.decode(errors="replace").strip()}')
    return json.loads(os.read(info_fd, MAX_ANSWER))['child-pid']


async def _forked(
    paths: KernelPaths, room: str, environment: dict[str, str], first: int
) -> tuple[int, int, socket.socket]:
    """Fork a kernel into the room whose first process is `first`.

    Return the kernel's pidfd, the listener for its signals (-1 for none), and the connection over
    which its exit status comes.
    """
    order = json.dumps(_order(paths, environment, first)).encode()
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    ours.setblocking(False)
    try:
        with contextlib.ExitStack() as opened:
            files = [os.pidfd_open(first)]
            opened.callback(os.close, files[0])
            for path in keeper_of(paths).entrances:
                files.append(os.open(path, os.O_WRONLY))
                opened.callback(os.close, files[-1])
            socket.send_fds(ours, [order], files)
            with theirs:
                server = await asyncio.to_thread(send, theirs, room=room)
        return *await _answer(ours, server), ours
    except BaseException:
        ours.close()
        raise


def _order(paths: KernelPaths, environment: dict[str, str], first: int) -> dict:
    """Return what the forked process needs to become a kernel in the room of process `first`."""
    folder = str(paths.inside / 'home' / 'work')
    return {
        'user': keeper_of(paths).user,
        'namespaces': [k for k in _NAMESPACES if _namespace(first, k) != _namespace('self', k)],
        'folder': folder,
        'limits': list(process_limits().items()),
        'oom_score_adj': OUT_OF_MEMORY_SCORE,
        'environment': environment | {'PWD': folder},
        'seccomp': seccomp_filter(counted=bool(keeper_of(paths).entrances)).hex(),
        'signals': signals_filter().hex(),
        'command': paths.kernel_command(),
    }


async def _answer(connection: socket.socket, server: RoomForkServer) -> tuple[int, int]:
    """Receive the pidfd and the listener from the forked process, until the kernel is ready."""
    found: dict[bytes, int] = {}
    problem = ''
    try:
        while not problem and set(found) != {b'kernel', b'ready'}:
            await readable(connection.fileno())
            try:
                text, files, _, _ = socket.recv_fds(connection, MAX_ANSWER, 1)
            except ConnectionResetError:  # the other end closed without reading what was sent
                text, files = b'', []
            if not text:
                raise server.failure()
            if text in (b'kernel', b'ready'):
                found[text] = files[0] if files else -1
            else:
                problem = text.decode(errors='replace')
        if problem:
            raise RoomFailure(f'the forked kernel could not enter its room: {problem}')
    except BaseException:
        for file in found.values():
            if file >= 0:
                os.close(file)
        raise
    server.settle()
    return found[b'kernel'], found[b'ready']


def _namespace(pid: int | str, kind: str) -> str:
    return os.readlink(f'/proc/{pid}/ns/{kind}')
