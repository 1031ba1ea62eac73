"""System calls that this version of Python has no function for."""

import ctypes
import mmap
import os
import struct

_MAP_FIXED = 0x10
_SECCOMP, _SET_MODE_FILTER, _NEW_LISTENER = 317, 1, 8

_libc = ctypes.CDLL(None, use_errno=True)
_libc.mmap.restype = ctypes.c_void_p


def call(name: str, *arguments: int | bytes) -> None:
    """Call a function of the C library that returns -1 on failure. Raises OSError then."""
    given = [ctypes.c_ulong(a) if isinstance(a, int) else a for a in arguments]
    if getattr(_libc, name)(*given) == -1:
        number = ctypes.get_errno()
        raise OSError(number, f'{name}: {os.strerror(number)}')


def listen(program: bytes) -> int:
    """Install a seccomp filter; return the file descriptor of its notifications, or -1."""
    instructions = ctypes.create_string_buffer(program, len(program))
    header = struct.pack('@HP', len(program) // 8, ctypes.addressof(instructions))
    return _libc.syscall(_SECCOMP, _SET_MODE_FILTER, _NEW_LISTENER, header)


def replace_by_private_memory(start: int, end: int) -> None:
    """Map empty read-only memory over an address range of this process. Raises OSError."""
    place = _libc.mmap(
        ctypes.c_void_p(start), ctypes.c_size_t(end - start), mmap.PROT_READ,
        mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | _MAP_FIXED, -1, ctypes.c_long(0),
    )  # fmt: skip
    if place != start:
        raise OSError(ctypes.get_errno(), 'mmap')
