"""A program that has imported what a kernel needs, and forks kernels into rooms.

It is run by its folder, so that nothing of the grader is loaded with it: whatever this process
holds, each kernel can read. The connection with the order for one kernel goes to a process forked
for it, so that no order is ever here: what one room is told stays unknown to the next.
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
    """Import, then fork a kernel for each connection that comes; returns in the kernels alone.

    Why it can't go on, it says over `control`. It ends when the process at the other end does.
    """
    _leave_no_names()
    gc.disable()  # to look for garbage meanwhile takes a tenth of the time, and finds a megabyte
    privilege_drop.close_all_but(control.fileno())  # the file of Python may be open, too
    try:
        before = dict(os.environ)
        imports.import_for(room)
        made = {name: text for name, text in os.environ.items() if before.get(name) != text}
        single_thread.become_alone()
    except Exception as error:
        control.send(f'{type(error).__name__}: {error}'[:2000].encode())
        os._exit(1)  # a thread may be what is wrong, and would be waited for
    gc.freeze()  # a collection in a kernel would else copy all of it
    gc.enable()
    # what ends is waited for by nobody; a kernel's parent waits for that alone
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
    """Let a student's modules be called as the ones beside this one are."""
    sys.path.remove(os.path.dirname(__file__))
    for module in (imports, libc, offline, privilege_drop, single_thread):
        del sys.modules[module.__name__]


if __name__ == '__main__':
    main(socket.socket(fileno=int(sys.argv[1])), sys.argv[2])
    # only a kernel comes here
    offline.keep_off_the_network()
    from ipykernel.kernelapp import launch_new_instance

    launch_new_instance()
