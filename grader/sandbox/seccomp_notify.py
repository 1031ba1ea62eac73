"""A seccomp filter that reports each system call that sends a signal in a room."""

import signal
import struct

# number of the call: the positions of the target and of the signal among its arguments
SENDING = {
    62: (0, 1),  # kill
    200: (None, 1),  # tkill: its target is a thread, of any process
    234: (0, 2),  # tgkill
    129: (0, 1),  # rt_sigqueueinfo
    297: (0, 2),  # rt_tgsigqueueinfo
    424: (None, 1),  # pidfd_send_signal: its target is a file descriptor
}
"""System call numbers of x86-64."""
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
"""A started kernel runs this first: it sends a pidfd of itself, and the filter's listener."""


def signals_filter() -> bytes:
    """Return a filter that notifies a listener of calls that send, or may cause, a signal."""
    program = [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_EQUAL, 1, 0, _ARCHITECTURE),
        (_RETURN, 0, 0, _ALLOW),  # the other filter kills processes of another architecture
        (_LOAD, 0, 0, 0),
    ]
    for number in (*SENDING, _TIMER_CREATE):
        program += [(_EQUAL, 0, 1, number), (_RETURN, 0, 0, _NOTIFY)]
    program += _where(_SETRLIMIT, 0, (_EQUAL, _RLIMIT_CPU))
    program += _where(_PRLIMIT, 1, (_EQUAL, _RLIMIT_CPU))
    program += _where(PRCTL, 0, (_EQUAL, _SET_PARENT_DEATH_SIGNAL))
    for command in (_SET_SIGNAL, _SET_OWNER, _SET_OWNER_OF):
        program += _where(_FCNTL, 1, (_EQUAL, command))
    program += [  # clone: a child's end may send any signal; usual are SIGCHLD, 0 for a thread
        (_EQUAL, 0, 6, _CLONE),
        (_LOAD, 0, 0, _ARGUMENT_AT[0]),
        (_AND, 0, 0, 0xFF),
        (_EQUAL, 2, 0, 0),
        (_EQUAL, 1, 0, signal.SIGCHLD),
        (_RETURN, 0, 0, _NOTIFY),
        (_LOAD, 0, 0, 0),
    ]
    # bubblewrap exits with such a status when a signal ended its command
    program += _where(EXIT_GROUP, 0, (_GREATER, 128), mask=0xFF)
    program.append((_RETURN, 0, 0, _ALLOW))
    return b''.join(struct.pack('=HBBI', *instruction) for instruction in program)


def _where(
    number: int, argument: int, test: tuple[int, int], *, mask: int = 0xFFFFFFFF
) -> list[tuple[int, int, int, int]]:
    """Return instructions that notify the listener of a call if one argument passes a test."""
    kind, value = test
    return [
        (_EQUAL, 0, 5, number),
        (_LOAD, 0, 0, _ARGUMENT_AT[argument]),
        (_AND, 0, 0, mask),
        (kind, 0, 1, value),
        (_RETURN, 0, 0, _NOTIFY),
        (_LOAD, 0, 0, 0),
    ]
