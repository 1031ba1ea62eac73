"""Make this process safe to fork: one thread, and no memory shared with other processes."""

import os
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import libc

_ASLEEP_SEC = 10.0


def become_single_threaded() -> None:
    """Drop the threads and shared memory that imports made. Raises RuntimeError if others remain.

    It returns in a child of the process that called it.
    """
    _leave_threads_behind()
    _unshare_memory()
    expect_nothing_shared()


def _leave_threads_behind() -> None:
    """Continue in a forked child, which has only this thread.

    LTTng, which comes with the ROS wheels, waits for its daemon in two threads. They do nothing
    else, and hold no lock while they sleep.
    """
    deadline = time.monotonic() + _ASLEEP_SEC
    while not all(_asleep(task) for task in _other_threads()):
        if time.monotonic() > deadline:
            raise RuntimeError('an import has started threads that do not come to rest')
        time.sleep(0.001)
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', DeprecationWarning)  # it warns that there are threads
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
    """Replace memory that an import shares with the machine by private memory."""
    for start, end in [(s, e) for s, e, _, path in _shared() if path.startswith('/dev/shm/')]:
        libc.replace_by_private_memory(start, end)


def _shared() -> Iterator[tuple[int, int, str, str]]:
    """Yield start, end, permissions and path of each shared mapping of this process."""
    for line in Path('/proc/self/maps').read_text(encoding='utf-8').splitlines():
        addresses, rights, _, _, _, *path = line.split(maxsplit=5)
        if rights.endswith('s'):
            start, end = (int(address, 16) for address in addresses.split('-'))
            yield start, end, rights, ''.join(path)


def expect_nothing_shared() -> None:
    """Raise RuntimeError if a fork would lose a thread, or share memory with other processes.

    Read-only mappings of files that each room has anyway are allowed.
    """
    threads = len(os.listdir('/proc/self/task'))
    if threads != 1 or threading.active_count() != 1:
        raise RuntimeError(f'there are {threads} threads, but a fork copies only one')
    python = Path('/proc/self/exe')
    if python.stat().st_uid == os.geteuid() != 0 and not os.readlink(python).startswith('/memfd:'):
        raise RuntimeError(f'{python.resolve()} belongs to this user: kernels could change it')
    for _, _, rights, path in _shared():
        if rights != 'r--s' or not path.startswith(('/usr/', sys.prefix, sys.base_prefix)):
            raise RuntimeError(f'an import has made shared memory: {rights} {path}')
