"""What a forked process does to become a kernel: join its room, and give up all privileges."""

import contextlib
import ctypes
import json
import os
import random
import resource
import signal
import socket
import struct
import sys
import time
from pathlib import Path
from typing import NoReturn

from libc import call, listen

_MAX_ORDER = 1_000_000
_MAX_FILES = 8
"""How many files come with an order: a pidfd of the room, a cgroup entry per hierarchy."""
_NAMESPACES = {
    'user': 0x10000000, 'mnt': 0x00020000, 'net': 0x40000000, 'pid': 0x20000000,
    'ipc': 0x08000000, 'uts': 0x04000000, 'cgroup': 0x02000000,
}  # fmt: skip
_PR_SET_DUMPABLE, _PR_SET_SECCOMP, _PR_CAPBSET_DROP = 4, 22, 24
_PR_SET_NO_NEW_PRIVS, _PR_CAP_AMBIENT = 38, 47
_SECCOMP_MODE_FILTER, _CLEAR_ALL, _CAPABILITIES_V3 = 2, 4, 0x20080522


def become_a_kernel(connection: socket.socket, made: dict[str, str]) -> None:
    """Receive an order, enter its room, and return in the process that becomes the kernel.

    `made` is what imports have added to the environment. `setns` moves only children into a PID
    namespace. So this process forks the kernel, stays outside, and reports the kernel's exit
    status. If anything fails, neither of the two returns.
    """
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        text, (room, *cgroups), _, _ = socket.recv_fds(connection, _MAX_ORDER, _MAX_FILES)
        for entrance in cgroups:
            os.write(entrance, b'0')  # this process joins; what it forks starts in the cgroup
        order = json.loads(text)
        order['environment'] |= made
        # in the room /proc is read-only: the kernel and all its processes inherit this value
        Path('/proc/self/oom_score_adj').write_text(str(order['oom_score_adj']), encoding='ascii')
        _enter(room, order)
        ours = os.getpgrp()
        os.setpgrp()
        if child := os.fork():
            os.setpgid(0, ours)  # signals that the kernel sends to its group must not come here
            socket.send_fds(connection, [b'kernel'], [os.pidfd_open(child)])
            _tell_the_end(connection, child)
        listener = _settle(order, keep=connection.fileno())
        socket.send_fds(connection, [b'ready'], [listener] if listener >= 0 else [])
        # set last: a user with more files in flight than this limit can send no file
        _limit(order, only_files=True)
    except BaseException as error:
        connection.send(f'{type(error).__name__}: {error}'[:2000].encode())
        os._exit(1)
    if listener >= 0:
        os.close(listener)
    connection.close()


def _tell_the_end(connection: socket.socket, child: int) -> NoReturn:
    """Wait for a kernel, and send its exit status and CPU seconds: only its parent gets them.

    Processes in the room can't see this process or send it a signal.
    """
    _drop_capabilities()
    close_all_but(connection.fileno())
    _, status, used = os.wait4(child, 0)
    with contextlib.suppress(OSError):  # the process that wanted to know has ended
        connection.send(json.dumps([status, used.ru_utime + used.ru_stime]).encode())
    os._exit(0)


def close_all_but(keep: int) -> None:
    """Close all files but the standard ones and `keep`."""
    os.closerange(3, keep)
    os.closerange(keep + 1, 1 << 20)


def _enter(room: int, order: dict) -> None:
    """Enter the namespaces of a pidfd's process; first take the slot's user ID, unknown inside."""
    if order['user'] is not None:
        os.setgroups([])
        os.setresgid(*[order['user']] * 3)
        os.setresuid(*[order['user']] * 3)
    call('setns', room, sum(_NAMESPACES[name] for name in order['namespaces']))


def _settle(order: dict, *, keep: int) -> int:
    """Give up all privileges, and set up what a new process has; only the file `keep` stays open.

    Return the listener for signals that are sent from here on; -1 if Linux reports none.
    """
    null = os.open('/dev/null', os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(null, standard)
    os.chdir(order['folder'])
    _drop_capabilities()
    call('prctl', _PR_SET_DUMPABLE, 1, 0, 0, 0)  # or /proc/self would belong to another user
    _limit(order, only_files=False)
    os.environ.clear()
    os.environ.update(order['environment'])
    time.tzset()
    close_all_but(keep)
    call('prctl', _PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    listener = listen(bytes.fromhex(order['signals']))
    _filter_system_calls(bytes.fromhex(order['seccomp']))
    _forget(order['command'])
    return listener


def _limit(order: dict, *, only_files: bool) -> None:
    """Set the limit on open files, or all other limits."""
    for kind, most in order['limits']:
        if (kind == resource.RLIMIT_NOFILE) is only_files:
            resource.setrlimit(kind, (most, most))


def _drop_capabilities() -> None:
    last = int(Path('/proc/sys/kernel/cap_last_cap').read_text(encoding='ascii'))
    for capability in range(last + 1):
        call('prctl', _PR_CAPBSET_DROP, capability, 0, 0, 0)
    call('prctl', _PR_CAP_AMBIENT, _CLEAR_ALL, 0, 0, 0)
    call('capset', struct.pack('=Ii', _CAPABILITIES_V3, 0), bytes(24))


def _filter_system_calls(program: bytes) -> None:
    instructions = ctypes.create_string_buffer(program, len(program))
    header = struct.pack('@HP', len(program) // 8, ctypes.addressof(instructions))
    call('prctl', _PR_SET_SECCOMP, _SECCOMP_MODE_FILTER, header, 0, 0)


def _forget(command: list[str]) -> None:
    """Remove what all forked kernels share: random state, cached listings, command lines."""
    random.seed()
    sys.modules['numpy'].random.seed()
    sys.path_importer_cache.clear()
    sys.orig_argv[:] = command
    sys.argv[:] = [sys.modules['ipykernel'].__path__[0] + '_launcher.py', *command[3:]]
