"""The seccomp filter, run here instruction by instruction, denies all that is not listed."""

import re
import struct
from pathlib import Path

import pytest

from grader.sandbox.seccomp import (
    AF_INET,
    AF_INET6,
    AF_NETLINK,
    AF_UNIX,
    PROTOCOLS,
    seccomp_filter,
)
from grader.sandbox.system_calls import ALLOWED

X86_64, AARCH64 = 0xC000003E, 0xC00000B7
ALLOW, KILL = 0x7FFF0000, 0x80000000
EPERM, ENOSYS, EAFNOSUPPORT = 0x00050001, 0x00050026, 0x00050061
HARMFUL = """
acct add_key adjtimex bpf chroot clock_adjtime clock_settime clone3 delete_module fadvise64
fanotify_init finit_module fsconfig fsmount fsopen fspick init_module inotify_init1 io_setup
io_uring_enter io_uring_register io_uring_setup ioperm iopl kcmp kexec_file_load kexec_load
keyctl lookup_dcookie mbind memfd_create memfd_secret migrate_pages mincore modify_ldt mount
mount_setattr move_mount move_pages mq_open msgget name_to_handle_at open_by_handle_at open_tree
perf_event_open personality pidfd_getfd pivot_root preadv2 process_madvise process_vm_readv
process_vm_writev ptrace quotactl quotactl_fd reboot remap_file_pages request_key semget
setdomainname sethostname setns settimeofday shmget swapoff swapon sync syslog umount2 unshare
uselib userfaultfd vhangup vmsplice
""".split()  # noqa: SIM905 - a list of that length is read more easily so
"""System calls that no room may make."""
NEWEST = range(453, 600)
"""Numbers of system calls that are newer than all of ours, file_setattr (469) among them."""
HEADER = Path('/usr/include/x86_64-linux-gnu/asm/unistd_64.h')


def outcome(number, *arguments, architecture=X86_64, counted=True):
    """Run the filter as Linux does, on one struct seccomp_data."""
    arguments = [*arguments, *[0] * 6][:6]
    data = struct.pack('=IIQ6Q', number, architecture, 0, *arguments)
    program = list(struct.iter_unpack('=HBBI', seccomp_filter(counted=counted)))
    at, accumulator = 0, 0
    while True:
        code, if_true, if_false, k = program[at]
        at += 1
        if code == 0x20:  # BPF_LD | BPF_W | BPF_ABS
            (accumulator,) = struct.unpack_from('=I', data, k)
        elif code == 0x15:  # BPF_JMP | BPF_JEQ | BPF_K
            at += if_true if accumulator == k else if_false
        elif code == 0x35:  # BPF_JMP | BPF_JGE | BPF_K
            at += if_true if accumulator >= k else if_false
        elif code == 0x45:  # BPF_JMP | BPF_JSET | BPF_K
            at += if_true if accumulator & k else if_false
        else:
            assert code == 0x06  # BPF_RET | BPF_K
            return k


def test_exactly_the_listed_system_calls_are_allowed():
    arguments = (AF_UNIX,)  # an allowed family of sockets, and a harmless flag of mmap and clone
    outcomes = {number: outcome(number, *arguments) for number in range(600)}
    outcomes[ALLOWED['seccomp']] = outcome(ALLOWED['seccomp'], 1, 8)  # only with a listener
    assert {n for n, came in outcomes.items() if came == ALLOW} == set(ALLOWED.values())
    assert set(outcomes.values()) == {ALLOW, ENOSYS}


def test_system_calls_newer_than_the_table_are_denied():
    assert {outcome(number) for number in NEWEST} == {ENOSYS}
    assert {outcome(number) for number in (2**31 - 1, 2**32 - 1)} == {ENOSYS}


@pytest.fixture(scope='module')
def known():
    if not HEADER.exists():
        pytest.skip('the C headers of Linux are not installed')
    return dict(re.findall(r'#define __NR_(\w+) (\d+)', HEADER.read_text()))


def test_harmful_system_calls_are_denied(known):
    assert set(HARMFUL) <= known.keys()
    assert {outcome(int(known[name])) for name in HARMFUL} == {ENOSYS}


def test_system_call_numbers_match_the_headers_of_this_machine(known):
    assert {n: int(known[n]) for n in ALLOWED if n in known}.items() <= ALLOWED.items()
    assert len(ALLOWED.keys() & known.keys()) > 230


def test_sockets_are_allowed_only_for_listed_families_and_protocols():
    socket = ALLOWED['socket']
    allowed = {
        (family, protocol)
        for family in range(64)
        for protocol in range(300)
        if outcome(socket, family, 2, protocol) == ALLOW
    }
    assert allowed == {(f, p) for f, protocols in PROTOCOLS.items() for p in protocols}
    assert PROTOCOLS[AF_NETLINK] == (0,)
    mptcp = 262
    assert {outcome(socket, f, 1, mptcp) for f in (AF_INET, AF_INET6)} == {EAFNOSUPPORT}


def test_socket_pairs_are_allowed_only_for_unix_sockets():
    pairs = {f for f in range(64) if outcome(ALLOWED['socketpair'], f, 1, 0) == ALLOW}
    assert pairs == {AF_UNIX}


NEW = [0x00020000, 0x02000000, 0x04000000, 0x08000000, 0x10000000, 0x20000000, 0x40000000]


def test_clone_is_refused_with_flags_for_new_namespaces():
    clone, thread, fork = ALLOWED['clone'], 0x003D0F00, 0x01200011
    assert {outcome(clone, flags) for flags in (thread, fork, 17)} == {ALLOW}
    assert {outcome(clone, flag | 17) for flag in NEW} == {EPERM}


def test_another_seccomp_filter_may_be_added_only_with_a_listener():
    assert outcome(ALLOWED['seccomp'], 1, 8) == ALLOW
    assert {outcome(ALLOWED['seccomp'], 1, flags) for flags in (0, 1, 9, 16)} == {EPERM}


SET_LEASE, GET_LEASE, NOTIFY = 1024, 1025, 1026


def test_fcntl_can_neither_take_a_lease_on_a_file_nor_watch_a_folder():
    fcntl = ALLOWED['fcntl']
    assert {outcome(fcntl, 3, command) for command in (SET_LEASE, NOTIFY)} == {EPERM}
    others = {*range(41), GET_LEASE, *range(1027, 1050)}
    assert {outcome(fcntl, 3, command) for command in others} == {ALLOW}


PRIVATE, SHARED, VALIDATED, ANONYMOUS = 0x02, 0x01, 0x03, 0x20


@pytest.mark.parametrize('counted', [True, False])
def test_shared_anonymous_memory_is_allowed_only_if_a_cgroup_counts_it(counted):
    def asked(flags):
        return outcome(ALLOWED['mmap'], 0, 4096, 3, flags, counted=counted)

    assert {asked(f) for f in (SHARED, VALIDATED, PRIVATE, PRIVATE | ANONYMOUS)} == {ALLOW}
    hidden = {asked(shared | ANONYMOUS) for shared in (SHARED, VALIDATED)}
    assert hidden == {ALLOW if counted else EPERM}


@pytest.mark.parametrize('number', [0, 1, ALLOWED['socket'], 165])
def test_system_calls_of_other_architectures_are_denied(number):
    assert outcome(number | 0x40000000) == ENOSYS
    assert outcome(number, architecture=AARCH64) == KILL
