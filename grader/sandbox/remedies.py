"""What to do about namespaces that a machine refuses, by what is known of it."""

import platform
from pathlib import Path


def remedy() -> str:
    """Return what to do about namespaces that are refused, by what is known of this machine."""
    for setting, value, wanted in (
        ('kernel/apparmor_restrict_unprivileged_userns', '1', '0'),
        ('kernel/unprivileged_userns_clone', '0', '1'),
        ('user/max_user_namespaces', '0', '10000'),
        ('user/max_net_namespaces', '0', '10000'),
    ):
        if _setting(setting) == value:
            assignment = f'{setting.replace("/", ".")}={wanted}'
            return (
                f'This system forbids it to ordinary programs: sudo sysctl -w {assignment}, and '
                f'put the line {assignment} into /etc/sysctl.d/60-sandbox.conf to keep it so'
            )
    if _in_container():
        return (
            'This is a container, and its guard forbids it: grade outside of it, or start it with '
            '--security-opt seccomp=unconfined --security-opt apparmor=unconfined '
            '--security-opt systempaths=unconfined (Docker and Podman), or --privileged'
        )
    if 'microsoft' in platform.release().lower() and 'wsl2' not in platform.release().lower():
        return 'This is WSL 1, which has no namespaces: wsl --set-version <distribution> 2'
    return 'User namespaces are needed, in Linux 5.14 or newer: another machine may have them'


def _setting(name: str) -> str:
    try:
        return Path('/proc/sys', name).read_text(encoding='ascii').strip()
    except OSError:
        return ''


def _in_container() -> bool:
    marks = ('/.dockerenv', '/run/.containerenv', '/run/systemd/container')
    return any(Path(mark).exists() for mark in marks)
