"""Run a command under a seccomp profile in Docker's format: FILE COMMAND [ARGUMENT]."""

import ctypes
import json
import os
import sys

ALLOW, ERRNO = 0x7FFF0000, 0x00050000
COMPARED = {'SCMP_CMP_LT': 2, 'SCMP_CMP_EQ': 4, 'SCMP_CMP_GT': 6, 'SCMP_CMP_MASKED_EQ': 7}


class Argument(ctypes.Structure):
    _fields_ = [
        ('index', ctypes.c_uint),
        ('op', ctypes.c_int),
        ('first', ctypes.c_uint64),
        ('second', ctypes.c_uint64),
    ]


def load(profile):
    """Apply the profile to this process."""
    library = ctypes.CDLL('libseccomp.so.2', use_errno=True)
    library.seccomp_init.restype = ctypes.c_void_p
    context = ctypes.c_void_p(library.seccomp_init(ERRNO | profile['defaultErrnoRet']))
    for rule in profile['syscalls']:
        action = ERRNO | rule['errnoRet'] if 'errnoRet' in rule else ALLOW
        arguments = [
            Argument(a['index'], COMPARED[a['op']], a['value'], a.get('valueTwo', 0))
            for a in rule.get('args', ())
        ]
        for name in rule['names']:
            number = library.seccomp_syscall_resolve_name(name.encode())
            if number < 0:  # it is of another architecture, or newer than this libseccomp
                continue
            array = (Argument * max(len(arguments), 1))(*arguments)
            added = library.seccomp_rule_add_array(
                context, ctypes.c_uint32(action), number, len(arguments), array
            )
            assert added == 0, (name, added)
    assert library.seccomp_load(context) == 0


if __name__ == '__main__':
    with open(sys.argv[1]) as file:
        load(json.load(file))
    os.execvp(sys.argv[2], sys.argv[2:])
