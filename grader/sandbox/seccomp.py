"""The seccomp filter of a room: a system call that it does not list ends with ENOSYS.

ENOSYS is what a Linux too old to have the call returns, so the C library and Python use another
one. For some allowed calls, the filter also checks the arguments. docs/decisions.md says why
libseccomp does not write it.
"""

import struct

from grader.sandbox.system_calls import ALLOWED

ENOSYS, EPERM, EAFNOSUPPORT = 38, 1, 97

AF_UNIX, AF_INET, AF_INET6, AF_NETLINK = 1, 2, 10, 16
PROTOCOLS = {
    AF_UNIX: (0, 1),
    AF_INET: (0, 6, 17),  # the default, TCP, UDP: not MPTCP, SCTP or ICMP
    AF_INET6: (0, 6, 17),
    AF_NETLINK: (0,),  # NETLINK_ROUTE lists the network interfaces
}
"""Protocols that are allowed, by family. Other families ignore network namespaces (AF_VSOCK)."""

_ARCHITECTURE = 0xC000003E  # AUDIT_ARCH_X86_64
_NAMESPACES = 0x7E020000  # the flags of clone that make new namespaces
_MAP_SHARED, _MAP_ANONYMOUS = 0x01, 0x20
_KILL, _ERROR, _ALLOW = 0x80000000, 0x00050000, 0x7FFF0000
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NEW_LISTENER = 8
_SET_LEASE, _NOTIFY = 1_024, 1_026
_NUMBER_AT, _ARCHITECTURE_AT, _ARGUMENTS_AT = 0, 4, 16

Instruction = tuple[int, int, int, int]
"""An opcode, how many instructions to skip if its test is true and if it is false, a number."""


def seccomp_filter(*, counted: bool = True) -> bytes:
    """Return the filter as `bwrap --seccomp` reads it: one struct sock_filter after another.

    Unless a cgroup counts the room's memory (`counted`), anonymous shared memory is refused: the
    watch over its processes would not see all of it.
    """
    program: list[Instruction] = [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_EQUAL, 1, 0, _ARCHITECTURE),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER_AT),
    ]
    closer = {'socket': _sockets(), 'socketpair': _pairs(), 'clone': _no_namespaces()}
    closer |= {'seccomp': _only_with_listener(), 'fcntl': _no_leases()}
    if not counted:
        closer['mmap'] = _no_hidden_memory()
    for name, instructions in closer.items():
        program += [(_EQUAL, 0, len(instructions), ALLOWED[name]), *instructions]
    for first, last in _ranges(set(ALLOWED.values())):
        program += [
            (_AT_LEAST, 0, 2, first),
            (_AT_LEAST, 1, 0, last + 1),
            (_RETURN, 0, 0, _ALLOW),
        ]
    program.append((_RETURN, 0, 0, _ERROR | ENOSYS))
    return b''.join(struct.pack('=HBBI', *instruction) for instruction in program)


def _sockets() -> list[Instruction]:
    found: list[Instruction] = []
    for family, protocols in PROTOCOLS.items():
        of_family = [_argument(2), *_one_of(protocols)]
        found += [_argument(0), (_EQUAL, 0, len(of_family), family), *of_family]
    return [*found, (_RETURN, 0, 0, _ERROR | EAFNOSUPPORT)]


def _pairs() -> list[Instruction]:
    return [_argument(0), *_one_of([AF_UNIX])]


def _one_of(values: tuple[int, ...] | list[int]) -> list[Instruction]:
    """Allow the call if the loaded value is one of these."""
    tests = [(_EQUAL, len(values) - i, 0, value) for i, value in enumerate(values)]
    return [*tests, (_RETURN, 0, 0, _ERROR | EAFNOSUPPORT), (_RETURN, 0, 0, _ALLOW)]


def _no_namespaces() -> list[Instruction]:
    refused, fine = (_RETURN, 0, 0, _ERROR | EPERM), (_RETURN, 0, 0, _ALLOW)
    return [_argument(0), (_ANY_BIT, 0, 1, _NAMESPACES), refused, fine]


def _only_with_listener() -> list[Instruction]:
    """Allow only a filter with a listener: `signals` sets that one, and Linux takes no second."""
    refused, fine = (_RETURN, 0, 0, _ERROR | EPERM), (_RETURN, 0, 0, _ALLOW)
    return [_argument(1), (_EQUAL, 1, 0, _NEW_LISTENER), refused, fine]


def _no_leases() -> list[Instruction]:
    """Refuse leases on files, and to be notified of what happens in a folder.

    If an ordinary user grades, files that all rooms share belong to that user. Linux gives leases
    on them in spite of a read-only mount, and whoever opens such a file then waits for 45 s.
    """
    refused, fine = (_RETURN, 0, 0, _ERROR | EPERM), (_RETURN, 0, 0, _ALLOW)
    return [_argument(1), (_EQUAL, 1, 0, _SET_LEASE), (_EQUAL, 0, 1, _NOTIFY), refused, fine]


def _no_hidden_memory() -> list[Instruction]:
    refused, fine = (_RETURN, 0, 0, _ERROR | EPERM), (_RETURN, 0, 0, _ALLOW)
    shared = (_ANY_BIT, 0, 2, _MAP_SHARED)
    return [_argument(3), shared, (_ANY_BIT, 0, 1, _MAP_ANONYMOUS), refused, fine]


def _argument(number: int) -> Instruction:
    """Load the lower 32 bits of an argument: Linux ignores the rest of those that we check."""
    return (_LOAD, 0, 0, _ARGUMENTS_AT + 8 * number)


def _ranges(numbers: set[int]) -> list[tuple[int, int]]:
    """Return the first and the last of each run of consecutive numbers."""
    firsts = sorted(number for number in numbers if number - 1 not in numbers)
    lasts = sorted(number for number in numbers if number + 1 not in numbers)
    return list(zip(firsts, lasts, strict=True))
