"""The processes that kernels are forked from: started on demand, ended with this process.

There is one for the students' kernels and one for the tests': all kernels of one server have the
same memory layout, and student code must not learn the layout of a test's kernel. They run
`forkserver`, which contains no data of the grader.
"""

import contextlib
import fcntl
import os
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO

from grader.sandbox.bubblewrap import ENVIRONMENT
from grader.sandbox.font_cache import font_cache
from grader.sandbox.kernel_paths import inherited_variables

MAX_ANSWER = 4_000
"""Bytes that are read of a message from a server, or from a process that it forked."""

_PROGRAM = Path(__file__).with_name('forkserver')
_ALL_SEALS = fcntl.F_SEAL_SEAL | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_WRITE


class NoForkedKernel(Exception):
    """Why kernels can't be forked on this machine; they can still be started one by one."""


class RoomForkServer:
    """A process that forks kernels until this process ends or closes it."""

    def __init__(self, room: str) -> None:
        """Start it for the 'student' or the 'test' room; it takes connections while it imports."""
        self._room, self._has_forked = room, False
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs, _python() as python:
            # -P: Python imports neither from the grader's folder nor from the current one
            self._first = subprocess.Popen(
                [sys.executable, '-P', str(_PROGRAM), str(theirs.fileno()), room],
                executable=f'/proc/self/fd/{python.fileno()}',
                env=_environment(),
                cwd='/',
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(), python.fileno()),
                start_new_session=True,
            )

    def send(self, connection: socket.socket) -> None:
        """Have it fork a process that gets this connection. Raises OSError if it has ended."""
        socket.send_fds(self._control, [b'.'], [connection.fileno()])

    def settle(self) -> None:
        """Reap the process that was started first; call this after a forked one has answered."""
        self._first.wait()
        self._has_forked = True

    def failure(self) -> NoForkedKernel:
        """Return why the server ended; call this when it has ended.

        If it has never forked, another one would fail in the same way: no more are started.
        """
        problem = self._last_words()
        if not self._has_forked:
            _unfit[self._room] = problem
        return NoForkedKernel(problem)

    def close(self) -> None:
        """Let the server end; the kernels that it has forked keep running."""
        self._control.close()

    def _last_words(self) -> str:
        self._first.wait()
        self._control.setblocking(False)
        for _ in range(2):  # the first call may report that the server left something unread
            with contextlib.suppress(OSError):
                if said := self._control.recv(MAX_ANSWER):
                    return said.decode(errors='replace')
        return 'the process that forks them has ended'


_servers: dict[str, RoomForkServer] = {}
_unfit: dict[str, str] = {}
"""By room: why no kernel can be forked for it on this machine."""
_lock = threading.Lock()


def require_forkable(room: str) -> None:
    """Raise NoForkedKernel if it is known that no kernel can be forked for this room."""
    if room in _unfit:
        raise NoForkedKernel(_unfit[room])


def send(connection: socket.socket, *, room: str) -> RoomForkServer:
    """Pass a connection on to the server of a room; start a new one if there is none or it ended.

    Raises NoForkedKernel if the new one ends, too.
    """
    with _lock:
        for _ in range(2):
            server = _servers.get(room) or _servers.setdefault(room, RoomForkServer(room))
            try:
                server.send(connection)
                return server
            except OSError:
                _servers.pop(room).close()
    raise NoForkedKernel('the process that forks them ends at once')


def start_servers() -> None:
    """Start the servers of both rooms early: they import before the first kernel is needed."""
    with _lock:
        for room in ('student', 'test'):
            if room not in _servers:
                _servers[room] = RoomForkServer(room)


def close_servers() -> None:
    """End the servers of this process; the next kernel starts new ones."""
    with _lock:
        while _servers:
            _servers.popitem()[1].close()


def _close_servers_in_child() -> None:
    global _lock
    _lock = threading.Lock()  # another thread may have held it when this process was forked
    close_servers()


# a forked process must not keep the servers alive; it may start its own
os.register_at_fork(after_in_child=_close_servers_in_child)


def _python() -> IO[bytes]:
    """Return this Python's file, or a copy that cannot be changed.

    Through /proc/self/exe, a kernel reaches the file that it was forked with, although its room
    mounts that file read-only. If the file belongs to the kernel's user, student code could
    destroy it.
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


def _environment() -> dict[str, str]:
    """Return a server's environment: that of its kernels, without what only a room provides."""
    own = {'MPLCONFIGDIR': font_cache()}
    return inherited_variables() | ENVIRONMENT | own
