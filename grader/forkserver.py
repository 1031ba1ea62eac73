"""A process that has imported what a kernel needs, and forks kernels into rooms.

It is run by its path, so that nothing of the grader is loaded with it: whatever this process
holds, each kernel can read. An errand, the order for one kernel, goes to a process that was forked
for it, so that no order is ever here: what one room is told stays unknown to the next.
"""

import ctypes
import gc
import importlib
import json
import mmap
import os
import random
import resource
import signal
import socket
import struct
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

ROOMS = {
    'student': ('my_robot_basics.checks.responder', 'my_robot_basics.checks.probe'),
    'test': (
        'my_robot_basics.checks',
        'my_robot_basics.checks.clock',
        'my_robot_basics.checks.graphs',
        'my_robot_basics.checks.latched',
        'my_robot_basics.checks.logs',
        'my_robot_basics.checks.looks',
        'my_robot_basics.checks.pictures',
        'my_robot_basics.checks.predictions',
        'my_robot_basics.checks.probe',
        'my_robot_basics.checks.recording',
        'my_robot_basics.checks.relays',
        'my_robot_basics.checks.seeds',
        'my_robot_basics.checks.stage',
        'my_robot_basics.checks.student',
        'my_robot_basics.checks.topics',
    ),
}
"""What is imported for each room, beside what both need. None of it holds a test."""
_BOTH = (
    'runpy',
    'ipykernel.kernelapp',
    'ipykernel.debugger',
    'IPython.core.completerlib',
    'IPython.core.display',
    'IPython.core.pylabtools',
    'IPython.extensions.storemagic',
    'IPython.display',
    'ipywidgets',
    'matplotlib.backends.backend_agg',
    'matplotlib.font_manager',
    'matplotlib.pyplot',
    'numpy',
    'rclpy',
    'rclpy.executors',
    'rclpy.node',
    'builtin_interfaces.msg',
    'geometry_msgs.msg',
    'rcl_interfaces.msg',
    'rcl_interfaces.srv',
    'rosgraph_msgs.msg',
    'sensor_msgs.msg',
    'std_msgs.msg',
    'my_robot_basics.two_link_kinematics',
    'my_robot_basics.live.classroom',
)

_MAX_ORDER = 1_000_000
_ASLEEP_SEC = 10.0
_MAP_FIXED = 0x10
_NAMESPACES = {
    'user': 0x10000000, 'mnt': 0x00020000, 'net': 0x40000000, 'pid': 0x20000000,
    'ipc': 0x08000000, 'uts': 0x04000000, 'cgroup': 0x02000000,
}  # fmt: skip
_PR_SET_DUMPABLE, _PR_SET_SECCOMP, _PR_CAPBSET_DROP = 4, 22, 24
_PR_SET_CHILD_SUBREAPER, _PR_SET_NO_NEW_PRIVS, _PR_CAP_AMBIENT = 36, 38, 47
_SECCOMP_MODE_FILTER, _CLEAR_ALL, _CAPABILITIES_V3 = 2, 4, 0x20080522

_libc = ctypes.CDLL(None, use_errno=True)
_libc.mmap.restype = ctypes.c_void_p


def main(control: socket.socket, room: str) -> None:
    """Import, then fork a kernel for each errand that comes; returns in the kernels alone.

    Why it can't go on, it says over `control`. It ends when whoever holds the other end does.
    """
    _close_all_but(control.fileno())  # the file of Python may be open, too
    try:
        before = dict(os.environ)
        for name in (*_BOTH, *ROOMS[room]):
            importlib.import_module(name)
        _load_type_supports()
        made = {name: text for name, text in os.environ.items() if before.get(name) != text}
        _leave_threads_behind()
        _unshare_memory()
        expect_nothing_shared()
    except Exception as error:
        control.send(f'{type(error).__name__}: {error}'[:2000].encode())
        os._exit(1)  # a thread may be what is wrong, and would be waited for
    gc.collect()
    gc.freeze()  # a collection in a kernel would else copy all of it
    # what ends is waited for by nobody; a kernel's parent leaves at once, and this process follows
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    _call('prctl', _PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    while True:
        word, sockets, _, _ = socket.recv_fds(control, 1, 1)
        if not word:
            raise SystemExit
        errand = socket.socket(fileno=sockets[0])
        if os.fork() == 0:
            control.close()
            _become_a_kernel(errand, made)
            return
        errand.close()


def _load_type_supports() -> None:
    """Load what ROS otherwise loads when the first node, publisher or subscription is made."""
    modules = [name for name in sys.modules if name.endswith(('.msg', '.srv'))]
    for package in sorted({name.partition('.')[0] for name in modules} | {'service_msgs'}):
        for kind in ('fastrtps_c', 'introspection_c'):
            ctypes.CDLL(f'lib{package}__rosidl_typesupport_{kind}.so')
    for name in modules:
        for thing in vars(sys.modules[name]).values():
            if hasattr(type(thing), '__import_type_support__'):
                type(thing).__import_type_support__()


def _leave_threads_behind() -> None:
    """Go on as a process that has this thread alone.

    LTTng, which the ROS wheels bring, waits for its daemon in two. They do nothing else, and hold
    no lock while they sleep.
    """
    deadline = time.monotonic() + _ASLEEP_SEC
    while not all(_asleep(task) for task in _other_threads()):
        if time.monotonic() > deadline:
            raise RuntimeError('an import has started threads that do not come to rest')
        time.sleep(0.001)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', DeprecationWarning)  # that there are threads, we know
        if os.fork():
            os._exit(0)


def _other_threads() -> list[str]:
    if threading.active_count() > 1:
        raise RuntimeError(f'an import has started threads: {threading.enumerate()}')
    return [task for task in os.listdir('/proc/self/task') if int(task) != os.getpid()]


def _asleep(task: str) -> bool:
    stat = Path('/proc/self/task', task, 'stat').read_text(encoding='utf-8')
    return stat.rpartition(')')[2].split()[0] == 'S'


def _unshare_memory() -> None:
    """Put memory of our own in the place of what an import shares with the machine."""
    for start, end in [(start, end) for start, end, _, path in _shared() if _in_memory(path)]:
        place = _libc.mmap(
            ctypes.c_void_p(start), ctypes.c_size_t(end - start), mmap.PROT_READ,
            mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | _MAP_FIXED, -1, ctypes.c_long(0),
        )  # fmt: skip
        if place != start:
            raise OSError(ctypes.get_errno(), 'mmap')


def _shared() -> Iterator[tuple[int, int, str, str]]:
    """Yield begin, end, rights and path of this process's shared memory."""
    for line in Path('/proc/self/maps').read_text(encoding='utf-8').splitlines():
        addresses, rights, _, _, _, *path = line.split(maxsplit=5)
        if rights.endswith('s'):
            start, end = (int(address, 16) for address in addresses.split('-'))
            yield start, end, rights, ''.join(path)


def _in_memory(path: str) -> bool:
    return path.startswith('/dev/shm/')


def expect_nothing_shared() -> None:
    """Raise RuntimeError where a fork would not get all, or would share memory with others.

    A read-only file that each room has anyway is no such memory.
    """
    threads = len(os.listdir('/proc/self/task'))
    if threads != 1 or threading.active_count() != 1:
        raise RuntimeError(f'there are {threads} threads, and none but one would be forked')
    python = Path('/proc/self/exe')
    if python.stat().st_uid == os.geteuid() != 0 and not os.readlink(python).startswith('/memfd:'):
        raise RuntimeError(f'{python.resolve()} is the own file of whom its kernels would be')
    for _, _, rights, path in _shared():
        if rights != 'r--s' or not path.startswith(('/usr/', sys.prefix, sys.base_prefix)):
            raise RuntimeError(f'an import has made shared memory: {rights} {path}')


def _become_a_kernel(errand: socket.socket, made: dict[str, str]) -> None:
    """Do as ordered, in the room of an errand, and return where only the kernel is left to start.

    The process that was forked first can't enter a PID namespace itself: its child does.
    """
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        text, (room,), _, _ = socket.recv_fds(errand, _MAX_ORDER, 1)
        order = json.loads(text)
        order['environment'] |= made
        _enter(room, order)
        os.setsid()
        if child := os.fork():
            socket.send_fds(errand, [b'kernel'], [os.pidfd_open(child)])
            os._exit(0)
        _settle(order, keep=errand.fileno())
    except BaseException as error:
        errand.send(f'{type(error).__name__}: {error}'[:2000].encode())
        os._exit(1)
    errand.close()  # its end says that all went well


def _enter(room: int, order: dict) -> None:
    """Go where the process of a pidfd is; groups and user first: they are not known there."""
    if order['user'] is not None:
        os.setgroups([])
        os.setresgid(*[order['user']] * 3)
        os.setresuid(*[order['user']] * 3)
    _call('setns', room, sum(_NAMESPACES[name] for name in order['namespaces']))


def _settle(order: dict, *, keep: int) -> None:
    """Give up all rights, and be as a new process is there; only the file `keep` stays open."""
    null = os.open('/dev/null', os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(null, standard)
    os.chdir(order['folder'])
    _drop_capabilities()
    _call('prctl', _PR_SET_DUMPABLE, 1, 0, 0, 0)  # else /proc/self would be somebody else's
    Path('/proc/self/oom_score_adj').write_text(str(order['oom_score_adj']), encoding='ascii')
    for kind, most in order['limits']:
        resource.setrlimit(kind, (most, most))
    os.environ.clear()
    os.environ.update(order['environment'])
    time.tzset()
    _call('prctl', _PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    _filter_system_calls(bytes.fromhex(order['seccomp']))
    _forget(order['command'])
    _close_all_but(keep)


def _forget(command: list[str]) -> None:
    """Have nothing in common with other kernels that was made up by chance, nor old listings."""
    random.seed()
    sys.modules['numpy'].random.seed()
    sys.path_importer_cache.clear()
    sys.orig_argv[:] = command
    sys.argv[:] = [sys.modules['ipykernel'].__path__[0] + '_launcher.py', *command[3:]]


def _close_all_but(keep: int) -> None:
    os.closerange(3, keep)
    os.closerange(keep + 1, 1 << 20)


def _drop_capabilities() -> None:
    last = int(Path('/proc/sys/kernel/cap_last_cap').read_text(encoding='ascii'))
    for capability in range(last + 1):
        _call('prctl', _PR_CAPBSET_DROP, capability, 0, 0, 0)
    _call('prctl', _PR_CAP_AMBIENT, _CLEAR_ALL, 0, 0, 0)
    _call('capset', struct.pack('=Ii', _CAPABILITIES_V3, 0), bytes(24))


def _filter_system_calls(program: bytes) -> None:
    instructions = ctypes.create_string_buffer(program, len(program))
    header = struct.pack('@HP', len(program) // 8, ctypes.addressof(instructions))
    _call('prctl', _PR_SET_SECCOMP, _SECCOMP_MODE_FILTER, header, 0, 0)


def _call(name: str, *arguments: int | bytes) -> None:
    """Call the C library; raises OSError."""
    given = [ctypes.c_ulong(a) if isinstance(a, int) else a for a in arguments]
    if getattr(_libc, name)(*given) == -1:
        number = ctypes.get_errno()
        raise OSError(number, f'{name}: {os.strerror(number)}')


if __name__ == '__main__':
    main(socket.socket(fileno=int(sys.argv[1])), sys.argv[2])
    # only a kernel comes here
    from ipykernel.kernelapp import launch_new_instance

    launch_new_instance()
