"""The processes that kernels are forked from: started when one is needed, ended with this one.

There is one for the students' kernels and one for the tests': kernels of one server lie alike in
memory, and the tests' need not lie as a student may know it. What runs in them is `forkserver`,
which holds nothing of the grader's.
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
from grader.sandbox.kernel_paths import passed_on

MAX_ANSWER = 4_000
"""Bytes that are read of what a server, or a process that it forked, has to say."""

_PROGRAM = Path(__file__).with_name('forkserver')
_ALL_SEALS = fcntl.F_SEAL_SEAL | fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_WRITE


class NoForkedKernel(Exception):
    """Why kernels can't be forked on this machine; they can be started all the same."""


class RoomForkServer:
    """A process that forks kernels, as long as this one lives and does not close it."""

    def __init__(self, room: str) -> None:
        """Start it for the 'student' or the 'test' room; it takes connections while it imports."""
        self._room, self._has_forked = room, False
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs, _python() as python:
            # safe path: neither the grader's folder nor where we are is looked in
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
        """Let it fork a process for a connection. Raises OSError where it has ended."""
        socket.send_fds(self._control, [b'.'], [connection.fileno()])

    def settle(self) -> None:
        """Forget the process that it was forked from; to be called when it has answered."""
        self._first.wait()
        self._has_forked = True

    def failure(self) -> NoForkedKernel:
        """Return why it ended; to be called when it has.

        Where it has never forked, the next one would not, either: none is started any more.
        """
        problem = self._last_words()
        if not self._has_forked:
            _unfit[self._room] = problem
        return NoForkedKernel(problem)

    def close(self) -> None:
        """Let it end; what it has forked lives on."""
        self._control.close()

    def _last_words(self) -> str:
        self._first.wait()
        self._control.setblocking(False)
        for _ in range(2):  # that it left something unread is told first
            with contextlib.suppress(OSError):
                if said := self._control.recv(MAX_ANSWER):
                    return said.decode(errors='replace')
        return 'the process that forks them has ended'


_servers: dict[str, RoomForkServer] = {}
_unfit: dict[str, str] = {}
"""Why no kernel can be forked for a room on this machine."""
_lock = threading.Lock()


def expect_fit(room: str) -> None:
    """Raise NoForkedKernel where it is known that no kernel can be forked for this room."""
    if room in _unfit:
        raise NoForkedKernel(_unfit[room])


def send(connection: socket.socket, *, room: str) -> RoomForkServer:
    """Pass a connection on to the server of a room, a new one where there is none or it has ended.

    Raises NoForkedKernel where that ends, too.
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
    """Let the servers of both rooms import already: the first kernels need not wait for it."""
    with _lock:
        for room in ('student', 'test'):
            if room not in _servers:
                _servers[room] = RoomForkServer(room)


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


def _environment() -> dict[str, str]:
    """Return the environment of a server: its kernels', except what only their rooms have."""
    return passed_on() | ENVIRONMENT | {'MPLCONFIGDIR': font_cache()}
