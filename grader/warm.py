"""The grader's side of warm kernels: servers that fork them, and the rooms that they join.

A server holds nothing of the grader's; see `forkserver`. There is one for the students' kernels
and one for the tests': kernels of one server lie alike in memory, and the tests' need not lie as a
student may know it.
"""

import asyncio
import contextlib
import fcntl
import json
import os
import select
import signal
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO

import matplotlib

from grader.bubblewrap import ENVIRONMENT
from grader.errors import RoomFailure
from grader.limits import OUT_OF_MEMORY_SCORE, PROCESS_LIMITS
from grader.places import Place, passed_on
from grader.seccomp import seccomp_filter

_SCRIPT = Path(__file__).with_name('forkserver.py')
_TIMEOUT_SEC = 60.0
_NAMESPACES = ('user', 'mnt', 'net', 'pid', 'ipc', 'uts', 'cgroup')
_MAX_ANSWER = 4_000
_ALL_SEALS = fcntl.F_SEAL_SEAL | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_WRITE


class NoWarmKernel(Exception):
    """Why kernels can't be forked on this machine; they can be started all the same."""


class Forked:
    """A kernel that was forked into a room, as subprocess.Popen would be it."""

    stdin = stdout = stderr = None

    def __init__(self, room: subprocess.Popen, kernel: int) -> None:
        """Take the process that keeps the room, and a pidfd of the kernel; both end together."""
        self._room, self._kernel = room, kernel
        self.pid = room.pid

    def poll(self) -> int | None:
        """Return None while it runs."""
        if self._kernel >= 0:
            if not _ended(self._kernel) and self._room.poll() is None:
                return None
            self.kill()
            if not _ended(self._kernel):
                return None
            os.close(self._kernel)
            self._kernel = -1
        return self._room.poll()

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end."""
        if self._kernel >= 0:
            select.select([self._kernel], [], [], timeout)
            self.poll()
        return self._room.wait(timeout)

    def kill(self) -> None:
        """End it, and all in its room."""
        self._room.kill()
        if self._kernel >= 0:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(self._kernel, signal.SIGKILL)

    def send_signal(self, number: int) -> None:
        """End it, whatever the signal: for an interrupt there are messages."""
        self.kill()

    terminate = kill


class _Server:
    """A process that forks kernels, as long as this one lives and does not close it."""

    has_forked = False

    def __init__(self, room: str) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs, _python() as python:
            # safe path: neither the grader's folder nor where we are is looked in
            self._first = subprocess.Popen(
                [sys.executable, '-P', str(_SCRIPT), str(theirs.fileno()), room],
                executable=f'/proc/self/fd/{python.fileno()}',
                env=_environment(),
                cwd='/',
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(), python.fileno()),
                start_new_session=True,
            )

    def send(self, errand: socket.socket) -> None:
        """Let it fork a process for an errand. Raises OSError where it has ended."""
        socket.send_fds(self._control, [b'.'], [errand.fileno()])

    def settle(self) -> None:
        """Forget the process that it was forked from; to be called when it has answered."""
        self._first.wait()
        self.has_forked = True

    def last_words(self) -> str:
        """Return why it ended; to be called when it has."""
        self._first.wait()
        self._control.setblocking(False)
        for _ in range(2):  # that it left something unread is told first
            with contextlib.suppress(OSError):
                if said := self._control.recv(_MAX_ANSWER):
                    return said.decode(errors='replace')
        return 'the process that forks them has ended'

    def close(self) -> None:
        self._control.close()


def _python() -> IO[bytes]:
    """Return the file of this Python, or a copy that nobody can change.

    A kernel reaches the file that it was forked with through /proc/self/exe, and not by the
    read-only way of its room. Where that is its user's own, it could be made unusable.
    """
    own = Path('/proc/self/exe')
    if own.stat().st_uid == os.geteuid() != 0:
        return _sealed_copy(own)
    return own.open('rb')


def _sealed_copy(path: Path) -> IO[bytes]:
    copy = os.fdopen(os.memfd_create('python', os.MFD_ALLOW_SEALING), 'r+b')
    copy.write(path.read_bytes())
    copy.flush()
    fcntl.fcntl(copy, fcntl.F_ADD_SEALS, _ALL_SEALS)
    return copy


_servers: dict[str, _Server] = {}
_unfit: dict[str, str] = {}
_lock = threading.Lock()


def close_servers() -> None:
    """End the servers of this process; the next kernel starts a new one."""
    with _lock:
        while _servers:
            _servers.popitem()[1].close()


def _let_go() -> None:
    global _lock
    _lock = threading.Lock()  # another thread may have held it when this process was forked
    close_servers()


# a forked process must not keep them alive; it may start its own
os.register_at_fork(after_in_child=_let_go)


async def fork_into(place: Place, *, room: str, environment: dict[str, str]) -> Forked:
    """Build the room of a place, and fork a kernel of the 'student' or 'test' kind into it.

    Raises NoWarmKernel where none can be forked, and RoomFailure where the room can't be built.
    """
    if room in _unfit:
        raise NoWarmKernel(_unfit[room])
    keeper = subprocess.Popen(
        place.keeper.command,
        bufsize=0,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
        pass_fds=place.keeper.pass_fds,
        env={'PATH': f'{os.defpath}:/usr/sbin:/sbin'},
    )
    try:
        async with asyncio.timeout(_TIMEOUT_SEC):
            first = await _built(keeper, place.keeper.told)
            return Forked(keeper, await _forked(place, room, environment, first))
    except BaseException:
        keeper.kill()
        keeper.wait()
        raise
    finally:
        keeper.stdout.close()


async def _built(keeper: subprocess.Popen, told: int) -> int:
    """Wait until a room is built; return the process ID of its first process."""
    await _readable(keeper.stdout.fileno())
    said = keeper.stdout.read(_MAX_ANSWER)
    if said != b'\n':
        raise RoomFailure(f'the room could not be built: {said.decode(errors="replace").strip()}')
    return json.loads(os.read(told, _MAX_ANSWER))['child-pid']


async def _forked(place: Place, room: str, environment: dict[str, str], first: int) -> int:
    """Return a pidfd of a kernel that was forked into the room of a first process."""
    folder = str(place.inside / 'home' / 'work')
    order = {
        'user': place.keeper.user,
        'namespaces': [k for k in _NAMESPACES if _namespace(first, k) != _namespace('self', k)],
        'folder': folder,
        'limits': list(PROCESS_LIMITS.items()),
        'oom_score_adj': OUT_OF_MEMORY_SCORE,
        'environment': environment | {'PWD': folder},
        'seccomp': seccomp_filter().hex(),
        'command': place.kernel_command(),
    }
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours:
        ours.setblocking(False)
        pidfd = os.pidfd_open(first)
        try:
            socket.send_fds(ours, [json.dumps(order).encode()], [pidfd])
            with theirs:
                server = await asyncio.to_thread(_send, theirs, room)
        finally:
            os.close(pidfd)
        return await _answer(ours, server, room)


async def _answer(errand: socket.socket, server: '_Server', room: str) -> int:
    """Return the pidfd that comes over an errand, when its end says that the kernel is ready."""
    kernel, said = -1, ''
    try:
        while True:
            await _readable(errand.fileno())
            try:
                text, files, _, _ = socket.recv_fds(errand, _MAX_ANSWER, 1)
            except ConnectionResetError:  # nobody has read what was sent
                break
            if not text:
                break
            if files:
                kernel = files[0]
            else:
                said = text.decode(errors='replace')
        if kernel < 0 and not said:
            problem = server.last_words()
            if not server.has_forked:
                _unfit[room] = problem  # the next one would not, either
            raise NoWarmKernel(problem)
        if said:
            raise RoomFailure(f'the forked kernel could not enter its room: {said}')
    except BaseException:
        if kernel >= 0:
            os.close(kernel)
        raise
    server.settle()
    return kernel


def _send(errand: socket.socket, room: str) -> '_Server':
    """Give an errand to the server of a room, a new one where there is none or it has ended."""
    with _lock:
        for _ in range(2):
            server = _servers.get(room) or _servers.setdefault(room, _Server(room))
            try:
                server.send(errand)
                return server
            except OSError:
                _servers.pop(room).close()
    raise NoWarmKernel('the process that forks them ends at once')


def _environment() -> dict[str, str]:
    """Return what a server is told: what its kernels are, but for what is only in their rooms."""
    return passed_on() | ENVIRONMENT | {'MPLCONFIGDIR': matplotlib.get_cachedir()}


def _namespace(pid: int | str, kind: str) -> str:
    return os.readlink(f'/proc/{pid}/ns/{kind}')


def _ended(process: int) -> bool:
    return bool(select.select([process], [], [], 0)[0])


async def _readable(file: int) -> None:
    """Wait until there is something to read, or no more to come."""
    loop, ready = asyncio.get_running_loop(), asyncio.Event()
    loop.add_reader(file, ready.set)
    try:
        await ready.wait()
    finally:
        loop.remove_reader(file)
