"""What prevents a sandbox on this machine: `python -P -m grader.sandbox.block_probe`.

It prints the first step that fails and its error. First it calls each system call with arguments
for which Linux itself returns another error than a seccomp filter does, which shows whether a
filter refuses it. Then it takes the steps of bubblewrap, one by one, in a child.
"""

import ctypes
import errno
import os
import sys
import tempfile
from collections.abc import Callable

NUMBERS = {
    'clone': 56,
    'pivot_root': 155,
    'mount': 165,
    'umount2': 166,
    'sethostname': 170,
    'unshare': 272,
    'setns': 308,
}
"""System calls that a sandbox needs and Docker's default profile refuses: x86-64 numbers."""
_NEW = {
    'user': 0x10000000,
    'mount': 0x20000,
    'uts': 0x4000000,
    'ipc': 0x8000000,
    'pid': 0x20000000,
    'net': 0x40000000,
    'cgroup': 0x2000000,
}
_SHARES_FILES, _NO_SUCH_FLAGS, _NOWHERE = 0x200, 0x8000_0000, 1
_PRIVATE = 0x4000 | 0x80000  # MS_REC | MS_SLAVE
_IMPOSSIBLE: dict[str, tuple[int, ...]] = {
    'unshare': (_NO_SUCH_FLAGS,),
    'clone': (_NEW['user'] | _SHARES_FILES, 0, 0, 0, 0),
    'setns': (-1, 0),
    'mount': (0, 0, _NOWHERE, 0, 0),
    'umount2': (0, _NO_SUCH_FLAGS),
}
"""By system call: arguments for which Linux returns EINVAL, EBADF or EFAULT to any caller."""
_libc = ctypes.CDLL(None, use_errno=True)
_libc.syscall.restype = ctypes.c_long


class BlockedError(Exception):
    """A step of building a sandbox failed; the arguments are its name and the error's name."""


def main() -> int:
    """Print the failing step and the error's name, or nothing; return the exit status."""
    sys.stdout.reconfigure(line_buffering=True)  # type: ignore[union-attr]  # it is a text file
    try:
        for name, arguments in _IMPOSSIBLE.items():
            if (number := call(name, *arguments)) in (errno.EPERM, errno.EACCES, errno.ENOSYS):
                raise BlockedError(f'filter {name}', errno.errorcode[number])
        _in_a_child(_build)
    except BlockedError as blocked:
        print(*blocked.args)
    return 0


def call(name: str, *arguments: int | bytes | None) -> int:
    """Make a system call; return its errno, or 0."""
    words = [ctypes.c_long(each) if isinstance(each, int) else each for each in arguments]
    done = _libc.syscall(ctypes.c_long(NUMBERS[name]), *words)
    return ctypes.get_errno() if done < 0 else 0


def _build() -> None:
    user, group = os.getuid(), os.getgid()
    _step('user', call('unshare', _NEW['user']))
    for file, line in (
        ('setgroups', 'deny'),
        ('uid_map', f'0 {user} 1'),
        ('gid_map', f'0 {group} 1'),
    ):
        try:
            with open(f'/proc/self/{file}', 'w') as target:
                target.write(line)
        except OSError as error:
            _step('uid_map', error.errno or 0)
    for name in ('mount', 'uts', 'ipc', 'net', 'cgroup', 'pid'):
        _step(name, call('unshare', _NEW[name]))
    _step('mounting', call('mount', b'none', b'/', None, _PRIVATE, None))
    _step('filter sethostname', call('sethostname', b'room', 4))
    number = call('pivot_root', _NOWHERE, _NOWHERE)
    _step('filter pivot_root', 0 if number == errno.EFAULT else number)
    _in_a_child(_mount_proc)  # it is the first process of the new PID namespace


def _mount_proc() -> None:
    place = tempfile.mkdtemp().encode()
    try:
        _step('proc', call('mount', b'proc', place, b'proc', 0, None))
        call('umount2', place, 0)
    finally:
        os.rmdir(place)


def _step(name: str, number: int) -> None:
    if number:
        raise BlockedError(name, errno.errorcode.get(number, str(number)))


def _in_a_child(work: Callable[[], None]) -> None:
    """Run `work` in a child process; raise the BlockedError that it raised there."""
    reading, writing = os.pipe()
    if not (child := os.fork()):
        status = 0
        try:
            work()
        except BlockedError as blocked:
            os.write(writing, '\n'.join(blocked.args).encode())
        except BaseException:  # the child must not continue with its parent's code
            sys.excepthook(*sys.exc_info())
            status = 1
        finally:
            os._exit(status)
    os.close(writing)
    with open(reading, encoding='ascii') as said:
        words = said.read()
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if words:
        raise BlockedError(*words.split('\n'))
    if status:
        raise RuntimeError(f'the child ended with status {status}')


if __name__ == '__main__':
    sys.exit(main())
