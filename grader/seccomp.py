"""Which system calls a room may not make: a filter that Linux runs, put together by hand.

No caller of these has any right to use them in a room; what is not there can't be attacked.
"""

import struct

FORBIDDEN = {
    # kernel memory, modules, tracing and other ways into the kernel's rare code
    'acct': 163,
    'add_key': 248,
    'bpf': 321,
    'delete_module': 176,
    'finit_module': 313,
    'init_module': 175,
    'io_uring_enter': 426,
    'io_uring_register': 427,
    'io_uring_setup': 425,
    'kcmp': 312,
    'kexec_file_load': 320,
    'kexec_load': 246,
    'keyctl': 250,
    'lookup_dcookie': 212,
    'perf_event_open': 298,
    'personality': 135,
    'process_vm_writev': 311,
    'ptrace': 101,
    'quotactl': 179,
    'quotactl_fd': 443,
    'reboot': 169,
    'request_key': 249,
    'swapoff': 168,
    'swapon': 167,
    'syslog': 103,
    'userfaultfd': 323,
    'uselib': 134,
    # memory that belongs to no process, so that nobody's is seen to grow
    'memfd_create': 319,
    'memfd_secret': 447,
    'shmget': 29,
    # other namespaces, and mounts in them
    'chroot': 161,
    'fsconfig': 431,
    'fsmount': 432,
    'fsopen': 430,
    'fspick': 433,
    'mount': 165,
    'mount_setattr': 442,
    'move_mount': 429,
    'name_to_handle_at': 303,
    'open_by_handle_at': 304,
    'open_tree': 428,
    'pivot_root': 155,
    'setns': 308,
    'umount2': 166,
    'unshare': 272,
    # the machine's clock, name and queues
    'adjtimex': 159,
    'clock_adjtime': 305,
    'clock_settime': 227,
    'iopl': 172,
    'ioperm': 173,
    'setdomainname': 171,
    'sethostname': 170,
    'settimeofday': 164,
    'vhangup': 153,
}
"""Numbers of x86-64, the one machine that the ROS packages exist for."""

SOCKET = 41
FAMILIES = {'AF_UNIX': 1, 'AF_INET': 2, 'AF_INET6': 10, 'AF_NETLINK': 16}
"""Kinds of sockets that stay: others, such as AF_VSOCK, know of no network namespace."""

_ARCHITECTURE = 0xC000003E  # AUDIT_ARCH_X86_64
_X32 = 0x40000000  # another set of system calls, on the same processor
_OTHER_MACHINE, _DENY, _ALLOW = 0x80000000, 0x00050001, 0x7FFF0000  # kill; EPERM; as asked
_LOAD, _EQUAL, _AT_LEAST, _RETURN = 0x20, 0x15, 0x35, 0x06
_NUMBER_AT, _ARCHITECTURE_AT, _FIRST_ARGUMENT_AT = 0, 4, 16


def seccomp_filter() -> bytes:
    """Return the filter as `bwrap --seccomp` reads it: struct sock_filter, one after the other."""
    # each test jumps over what follows it where it finds nothing
    program = [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_EQUAL, 1, 0, _ARCHITECTURE),
        (_RETURN, 0, 0, _OTHER_MACHINE),
        (_LOAD, 0, 0, _NUMBER_AT),
        (_AT_LEAST, 0, 1, _X32),
        (_RETURN, 0, 0, _DENY),
    ]
    for number in sorted(FORBIDDEN.values()):
        program += [(_EQUAL, 0, 1, number), (_RETURN, 0, 0, _DENY)]
    families = sorted(FAMILIES.values())
    program += [
        (_EQUAL, 1, 0, SOCKET),
        (_RETURN, 0, 0, _ALLOW),
        (_LOAD, 0, 0, _FIRST_ARGUMENT_AT),
        *((_EQUAL, len(families) - i, 0, family) for i, family in enumerate(families)),
        (_RETURN, 0, 0, _DENY),
        (_RETURN, 0, 0, _ALLOW),
    ]
    return b''.join(struct.pack('=HBBI', *instruction) for instruction in program)
