"""A program that has imported what a kernel needs, and forks kernels into rooms.

It is run by the path of its folder, so that no module of the grader is loaded: each kernel can
read all memory of this process. The connection with the order for a kernel goes to a process
forked for it. This process reads no order, so nothing sent to one room reaches the next.
"""

import contextlib
import gc
import os
import select
import signal
import socket
import sys
from collections.abc import Callable, Iterator

import imports
import libc
import offline
import privilege_drop
import single_thread

IDLE_SEC = 0.5
"""So long after a kernel was forked, it has begun to wait for its nodes."""
_PR_SET_CHILD_SUBREAPER = 36


def main(control: socket.socket, room: str) -> None:
    """Import, then fork a kernel for each connection that comes; returns only in the kernels.

    It imports what few kernels need when it has forked one and no other is wanted for a while. If
    it can't go on, it sends the reason over `control`. It ends when the other end closes.
    """
    _leave_no_names()
    privilege_drop.close_all_but(control.fileno())  # the file of Python may be open, too
    with _sending_faults(control):
        made = _import(imports.import_for, room)
        single_thread.become_single_threaded()
    # Linux reaps ended processes itself; only a kernel's parent waits, for its kernel alone
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    libc.call('prctl', _PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    if _serve(control, made, idle_sec=IDLE_SEC):
        return
    with _sending_faults(control):
        made |= _import(imports.import_when_idle)
        single_thread.expect_nothing_shared()
    _serve(control, made)


def _serve(control: socket.socket, made: dict[str, str], idle_sec: float | None = None) -> bool:
    """Fork a kernel for each connection; return True in it, and False in an idle server.

    A server is idle if it has forked a kernel, and for `idle_sec` no other is wanted.
    """
    timeout_sec = None
    while select.select([control], [], [], timeout_sec)[0]:
        word, sockets, _, _ = socket.recv_fds(control, 1, 1)
        if not word:
            raise SystemExit
        connection = socket.socket(fileno=sockets[0])
        if os.fork() == 0:
            control.close()
            privilege_drop.become_a_kernel(connection, made)
            return True
        connection.close()
        timeout_sec = idle_sec
    return False


@contextlib.contextmanager
def _sending_faults(control: socket.socket) -> Iterator[None]:
    """Send the reason if something fails, and end this process."""
    try:
        yield
    except Exception as error:
        control.send(f'{type(error).__name__}: {error}'[:2000].encode())
        os._exit(1)  # a normal exit would wait for threads, and a thread may be the problem


def _import(function: Callable[..., None], *arguments: str) -> dict[str, str]:
    """Call a function that imports; return what it has added to the environment."""
    before = dict(os.environ)
    gc.disable()  # garbage collection takes a tenth of the import time, and frees one megabyte
    sys.dont_write_bytecode = False  # or each server would compile the course's modules again
    function(*arguments)
    sys.dont_write_bytecode = True  # from here on, what is imported may be the student's
    gc.freeze()  # or a garbage collection in a kernel would copy all of this memory
    gc.enable()
    return {name: text for name, text in os.environ.items() if before.get(name) != text}


def _leave_no_names() -> None:
    """Let a student's modules have the same names as the modules in this folder."""
    sys.path.remove(os.path.dirname(__file__))
    for module in (imports, libc, offline, privilege_drop, single_thread):
        del sys.modules[module.__name__]


if __name__ == '__main__':
    main(socket.socket(fileno=int(sys.argv[1])), sys.argv[2])
    # only a kernel reaches this line
    offline.keep_off_the_network()
    from ipykernel.kernelapp import launch_new_instance

    launch_new_instance()
