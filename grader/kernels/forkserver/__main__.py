"""A program that has imported what a kernel needs, and forks kernels into rooms.

It is run by the path of its folder, so that no module of the grader is loaded: each kernel can
read all memory of this process. The connection with the order for a kernel goes to a process
forked for it. This process reads no order, so nothing sent to one room reaches the next.
"""

import gc
import os
import signal
import socket
import sys

import imports
import libc
import offline
import privilege_drop
import single_thread

_PR_SET_CHILD_SUBREAPER = 36


def main(control: socket.socket, room: str) -> None:
    """Import, then fork a kernel for each connection that comes; returns only in the kernels.

    If it can't go on, it sends the reason over `control`. It ends when the other end closes.
    """
    _leave_no_names()
    gc.disable()  # garbage collection takes a tenth of the import time, and frees one megabyte
    privilege_drop.close_all_but(control.fileno())  # the file of Python may be open, too
    try:
        before = dict(os.environ)
        sys.dont_write_bytecode = False  # or each server would compile the course's modules again
        imports.import_for(room)
        made = {name: text for name, text in os.environ.items() if before.get(name) != text}
        single_thread.become_single_threaded()
    except Exception as error:
        control.send(f'{type(error).__name__}: {error}'[:2000].encode())
        os._exit(1)  # a normal exit would wait for threads, and a thread may be the problem
    sys.dont_write_bytecode = True  # from here on, what is imported may be the student's
    gc.freeze()  # or a garbage collection in a kernel would copy all of this memory
    gc.enable()
    # Linux reaps ended processes itself; only a kernel's parent waits, for its kernel alone
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    libc.call('prctl', _PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    while True:
        word, sockets, _, _ = socket.recv_fds(control, 1, 1)
        if not word:
            raise SystemExit
        connection = socket.socket(fileno=sockets[0])
        if os.fork() == 0:
            control.close()
            privilege_drop.become_a_kernel(connection, made)
            return
        connection.close()


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
