"""The filter of system calls that passes on to us what sends a signal in a room."""

import signal
import struct

# number: the places of its target and of the signal among its arguments
SENDING = {
    62: (0, 1),  # kill
    200: (None, 1),  # tkill: names a thread, of any process
    234: (0, 2),  # tgkill
    129: (0, 1),  # rt_sigqueueinfo
    297: (0, 2),  # rt_tgsigqueueinfo
    424: (None, 1),  # pidfd_send_signal: names a file
}
"""Numbers of x86-64."""
EXIT_GROUP, PRCTL = 231, 157
_CLONE, _FCNTL, _PRLIMIT, _SETRLIMIT, _TIMER_CREATE = 56, 72, 302, 160, 222
_SET_SIGNAL, _SET_OWNER, _SET_OWNER_OF = 10, 8, 15
_RLIMIT_CPU = 0
_SET_PARENT_DEATH_SIGNAL = 1
_ARCHITECTURE = 0xC000003E  # AUDIT_ARCH_X86_64
_NOTIFY, _ALLOW = 0x7FC00000, 0x7FFF0000
_LOAD, _AND, _EQUAL, _GREATER, _RETURN = 0x20, 0x54, 0x15, 0x25, 0x06
_ARCHITECTURE_AT, _ARGUMENT_AT = 4, (16, 24, 32)

SHIM = """
import ctypes, os, socket, struct, sys
libc = ctypes.CDLL(None)
door, program = socket.socket(fileno=int(sys.argv[1])), bytes.fromhex(sys.argv[2])
code = ctypes.create_string_buffer(program, len(program))
libc.prctl(38, 1, 0, 0, 0)  # no new privileges, without which no filter is taken
header = struct.pack('@HP', len(program) // 8, ctypes.addressof(code))
files = [os.pidfd_open(os.getpid())]
listener = libc.syscall(317, 1, 8, header)  # seccomp: set a filter, with a listener
if listener >= 0:
    files.append(listener)
socket.send_fds(door, [b'kernel'], files)
for file in files:
    os.close(file)
door.close()
os.execv(sys.argv[3], sys.argv[3:])
"""
"""What a kernel that is started runs first: it sends a pidfd of itself, and the listener."""


def signals_filter() -> bytes:
    """Return a filter that passes on to a listener what sends a signal, or may have one sent."""
    program = [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_EQUAL, 1, 0, _ARCHITECTURE),
        (_RETURN, 0, 0, _ALLOW),  # another filter ends such processes
        (_LOAD, 0, 0, 0),
    ]
    for number in (*SENDING, _TIMER_CREATE):
        program += [(_EQUAL, 0, 1, number), (_RETURN, 0, 0, _NOTIFY)]
    program += _where(_SETRLIMIT, 0, (_EQUAL, _RLIMIT_CPU))
    program += _where(_PRLIMIT, 1, (_EQUAL, _RLIMIT_CPU))
    program += _where(PRCTL, 0, (_EQUAL, _SET_PARENT_DEATH_SIGNAL))
    for command in (_SET_SIGNAL, _SET_OWNER, _SET_OWNER_OF):
        program += _where(_FCNTL, 1, (_EQUAL, command))
    program += [  # a child may announce its end by any signal; a process' is SIGCHLD, a thread's 0
        (_EQUAL, 0, 6, _CLONE),
        (_LOAD, 0, 0, _ARGUMENT_AT[0]),
        (_AND, 0, 0, 0xFF),
        (_EQUAL, 2, 0, 0),
        (_EQUAL, 1, 0, signal.SIGCHLD),
        (_RETURN, 0, 0, _NOTIFY),
        (_LOAD, 0, 0, 0),
    ]
    # bubblewrap tells a death by a signal as such a code
    program += _where(EXIT_GROUP, 0, (_GREATER, 128), mask=0xFF)
    program.append((_RETURN, 0, 0, _ALLOW))
    return b''.join(struct.pack('=HBBI', *instruction) for instruction in program)


def _where(
    number: int, argument: int, test: tuple[int, int], *, mask: int = 0xFFFFFFFF
) -> list[tuple[int, int, int, int]]:
    """Return what passes a call on where one of its arguments is as a test says."""
    kind, value = test
    return [
        (_EQUAL, 0, 5, number),
        (_LOAD, 0, 0, _ARGUMENT_AT[argument]),
        (_AND, 0, 0, mask),
        (kind, 0, 1, value),
        (_RETURN, 0, 0, _NOTIFY),
        (_LOAD, 0, 0, 0),
    ]
