"""What prevents a sandbox on this machine, and the smallest change that allows it."""

import os
import platform
import subprocess
import sys
from pathlib import Path

PROFILE = 'deploy/seccomp.json'
CONTAINERS = 'docs/where-it-runs.md has the whole line'
_SYS_ADMIN = 21
"""The number of the capability CAP_SYS_ADMIN, which is its bit in CapEff."""
_APPARMOR = 'kernel/apparmor_restrict_unprivileged_userns'
_SETTINGS = (
    (_APPARMOR, '1', '0'),
    ('kernel/unprivileged_userns_clone', '0', '1'),
    ('user/max_user_namespaces', '0', '10000'),
    ('user/max_net_namespaces', '0', '10000'),
)


def remedy() -> str:
    """Return what prevents a sandbox here, and what to do about it, in sentences."""
    step, _, error = _first_block().rpartition(' ')
    if step.startswith('filter '):
        return _about_a_filter(step.removeprefix('filter '), error)
    if step == 'proc':
        return _about_proc()
    if error == 'ENOSPC':
        return (
            f'No further {step} namespaces are allowed: sudo sysctl -w user.max_{step}_namespaces='
            '10000, on the machine around it too if this is a container'
        )
    if found := _forbidden_by_a_setting():
        return found
    if step in ('uid_map', 'mounting', 'mount', 'uts', 'ipc', 'net', 'pid'):
        return _about_apparmor(step, error)
    if _in_container() and os.geteuid() == 0 and not _has_sys_admin():
        return (
            'Root lacks CAP_SYS_ADMIN in this container, and bubblewrap makes no user namespace '
            'for root: grade as an ordinary user, with --user 1000:1000 '
            f'(Docker and Podman); no capability is needed then. {CONTAINERS}'
        )
    if _in_container():
        return f'This is a container that allows too little: {CONTAINERS}'
    if 'microsoft' in platform.release().lower() and 'wsl2' not in platform.release().lower():
        return 'This is WSL 1, which has no namespaces: wsl --set-version <distribution> 2'
    return 'User namespaces are needed, in Linux 5.14 or newer: another machine may have them'


def _first_block() -> str:
    """Return the first step of building a sandbox that fails, and its error; '' if none does."""
    command = [sys.executable, '-P', '-m', 'grader.sandbox.block_probe']
    tried = subprocess.run(command, capture_output=True, text=True)
    if tried.returncode < 0:  # a filter that kills the calling process
        return 'filter (it ended the process that asked) SIGSYS'
    return tried.stdout.strip()


def _about_a_filter(call: str, error: str) -> str:
    what = f'A seccomp filter refuses the system call {call} ({error}), which bubblewrap needs'
    if _in_container():
        return (
            f'{what}: start the container with --security-opt seccomp={PROFILE} (Docker and '
            "Podman), which is Docker's default profile and seven system calls more. "
            f'{CONTAINERS}'
        )
    return (
        f'{what}: if systemd started this, remove SystemCallFilter= and RestrictNamespaces= from '
        'its unit'
    )


def _about_proc() -> str:
    masked = sorted(_mounted_below_proc())
    named = ', '.join(masked[:3]) + (', …' if len(masked) > 3 else '')
    what = f'/proc is masked ({named or "in part"}), so Linux does not let a sandbox mount its own'
    if _in_container():
        return (
            f'{what}: start the container with --security-opt systempaths=unconfined (Docker) or '
            f'--security-opt unmask=ALL (Podman). {CONTAINERS}'
        )
    return (
        f'{what}: if systemd started this, leave ProtectKernelTunables=, ProtectKernelLogs=, '
        'ProtectControlGroups= and ProcSubset= out of its unit'
    )


def _about_apparmor(step: str, error: str) -> str:
    profile = _read('/proc/self/attr/current') or 'a profile of AppArmor or SELinux'
    what = f'{profile} forbids what bubblewrap does first ({step}: {error})'
    if _in_container():
        return (
            f'{what}: start the container with --security-opt apparmor=unconfined (Docker and '
            f'Podman), or with --security-opt label=disable where it is SELinux. {CONTAINERS}'
        )
    return f'{what}: allow userns and mount in that profile'


def _forbidden_by_a_setting() -> str:
    for setting, value, wanted in _SETTINGS:
        if _setting(setting) == value:
            assignment = f'{setting.replace("/", ".")}={wanted}'
            return (
                f'This system forbids it to ordinary programs: sudo sysctl -w {assignment}, and '
                f'put the line {assignment} into /etc/sysctl.d/60-sandbox.conf to keep it so'
            )
    return ''


def _mounted_below_proc() -> set[str]:
    mounts = (line.split()[4] for line in _read('/proc/self/mountinfo').splitlines())
    return {place for place in mounts if place.startswith('/proc/')}


def _has_sys_admin() -> bool:
    lines = _read('/proc/self/status').splitlines()
    (mask,) = (line.split()[1] for line in lines if line.startswith('CapEff:'))
    return bool(int(mask, 16) >> _SYS_ADMIN & 1)


def _setting(name: str) -> str:
    return _read(f'/proc/sys/{name}')


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding='utf-8').strip('\0\n ')
    except OSError:
        return ''


def _in_container() -> bool:
    marks = ('/.dockerenv', '/run/.containerenv', '/run/systemd/container')
    return any(Path(mark).exists() for mark in marks)
