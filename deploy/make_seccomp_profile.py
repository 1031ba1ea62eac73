"""Write deploy/seccomp.json: Docker's default seccomp profile, and what building a sandbox needs.

`.venv/bin/python deploy/make_seccomp_profile.py`. libseccomp names the system calls of x86-64;
left out are those that Docker blocks by default in a container without their capabilities.
A newer libseccomp knows newer ones: look at what has changed before you commit it.
"""

import ctypes
import json
from pathlib import Path

X86_64 = 0xC000003E  # AUDIT_ARCH_X86_64
HIGHEST = 600
"""No number of a system call of x86-64 is higher."""
TARGET = Path(__file__).with_name('seccomp.json')
ADDED = ('clone', 'mount', 'pivot_root', 'sethostname', 'setns', 'umount2', 'unshare')
"""What bubblewrap, nsenter and mount were seen to make while `./course doctor` built a sandbox."""
ENOSYS_INSTEAD = ('clone3',)
"""A filter can't see its flags: the C library takes clone where it is not there."""
BLOCKED = {
    'modules, the boot, swap, the clock, names and accounts of the machine': """
        acct clock_settime delete_module finit_module init_module ioperm iopl
        kexec_file_load kexec_load quotactl quotactl_fd reboot setdomainname settimeofday swapoff
        swapon syslog vhangup""",
    'namespaces and mounts, but for those that are added': """
        chroot fsconfig fsmount fsopen fspick mount_setattr move_mount open_tree""",
    'other processes, and memory of other nodes': """
        get_mempolicy kcmp mbind migrate_pages move_pages pidfd_getfd process_madvise
        set_mempolicy set_mempolicy_home_node""",
    'what has no namespace, or a history of holes': """
        add_key bpf fanotify_init io_uring_enter io_uring_register io_uring_setup keyctl
        lookup_dcookie open_by_handle_at perf_event_open request_key userfaultfd""",
    'what is old': """
        _sysctl afs_syscall create_module get_kernel_syms getpmsg nfsservctl putpmsg
        query_module security sysfs tuxcall uselib ustat vserver""",
}
PERSONALITIES = (0x0, 0x8, 0x20000, 0x20008, 0xFFFFFFFF)
VSOCK = 40
"""A family of sockets that knows of no network namespace."""


def main() -> None:
    """Write the profile."""
    TARGET.write_text(json.dumps(profile(), indent=1) + '\n', encoding='utf-8')


def profile() -> dict[str, object]:
    """Return the profile as Docker and Podman read it."""
    blocked = {name for names in BLOCKED.values() for name in names.split()}
    closer = {'personality', 'socket', *ENOSYS_INSTEAD}
    allowed = sorted((known_system_calls() - blocked - closer) | {*ADDED})
    rules: list[dict[str, object]] = [{'names': allowed, 'action': 'SCMP_ACT_ALLOW'}]
    for value in PERSONALITIES:
        rules.append(_where('personality', value, 'SCMP_CMP_EQ'))
    for compared in ('SCMP_CMP_LT', 'SCMP_CMP_GT'):
        rules.append(_where('socket', VSOCK, compared))
    rules.append({'names': [*ENOSYS_INSTEAD], 'action': 'SCMP_ACT_ERRNO', 'errnoRet': 38})
    return {
        'defaultAction': 'SCMP_ACT_ERRNO',
        'defaultErrnoRet': 1,
        'archMap': [{'architecture': 'SCMP_ARCH_X86_64', 'subArchitectures': []}],
        'syscalls': rules,
    }


def known_system_calls() -> set[str]:
    """Return the names of all system calls of x86-64 that this libseccomp knows."""
    resolve = ctypes.CDLL('libseccomp.so.2').seccomp_syscall_resolve_num_arch
    resolve.restype, resolve.argtypes = ctypes.c_char_p, [ctypes.c_uint32, ctypes.c_int]
    names = (resolve(X86_64, number) for number in range(HIGHEST))
    return {name.decode() for name in names if name}


def _where(name: str, value: int, compared: str) -> dict[str, object]:
    argument = {'index': 0, 'value': value, 'op': compared}
    return {'names': [name], 'action': 'SCMP_ACT_ALLOW', 'args': [argument]}


if __name__ == '__main__':
    main()
