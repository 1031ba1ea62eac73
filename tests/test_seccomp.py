"""The filter, run here instruction by instruction: only what is forbidden is denied."""

import re
import struct
from pathlib import Path

import pytest

from grader.seccomp import FAMILIES, FORBIDDEN, SOCKET, seccomp_filter

X86_64, AARCH64 = 0xC000003E, 0xC00000B7
ALLOW, EPERM, KILL = 0x7FFF0000, 0x00050001, 0x80000000


def outcome(number, argument=0, architecture=X86_64):
    """Run the filter as Linux does, on one struct seccomp_data."""
    data = struct.pack('=IIQ6Q', number, architecture, 0, argument, *[0] * 5)
    program = list(struct.iter_unpack('=HBBI', seccomp_filter()))
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
        else:
            assert code == 0x06  # BPF_RET | BPF_K
            return k


def test_exactly_what_is_forbidden_is_denied():
    denied = {number for number in range(600) if outcome(number, FAMILIES['AF_INET']) != ALLOW}
    assert denied == set(FORBIDDEN.values())
    assert {outcome(number) for number in denied} == {EPERM}


def test_only_some_families_have_sockets():
    allowed = {family for family in range(64) if outcome(SOCKET, family) == ALLOW}
    assert allowed == set(FAMILIES.values())


@pytest.mark.parametrize('number', [0, 1, SOCKET, FORBIDDEN['mount']])
def test_another_set_of_system_calls_is_none(number):
    assert outcome(number | 0x40000000) == EPERM
    assert outcome(number, architecture=AARCH64) == KILL


def test_the_numbers_are_those_of_this_machines_headers():
    header = Path('/usr/include/x86_64-linux-gnu/asm/unistd_64.h')
    if not header.exists():
        pytest.skip('the C headers of Linux are not installed')
    known = dict(re.findall(r'#define __NR_(\w+) (\d+)', header.read_text()))
    assert {n: int(known[n]) for n in FORBIDDEN if n in known}.items() <= FORBIDDEN.items()
    assert int(known['socket']) == SOCKET
