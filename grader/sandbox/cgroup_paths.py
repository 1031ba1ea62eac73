"""Which cgroups a process is in, and the folders at which they are mounted."""

import os
from collections.abc import Iterator
from pathlib import Path


def own_paths(proc: Path) -> dict[str, str]:
    """Return the cgroup of this process by controller; that of version 2 has the key ''."""
    lines = (proc / 'cgroup').read_text(encoding='utf-8').splitlines()
    whole = [line.split(':', 2) for line in lines]
    return {name: path for _, names, path in whole for name in names.split(',')}


def _mounts(proc: Path, controller: str) -> Iterator[tuple[str, str]]:
    """Yield the root and the mount point of each mount of a controller's hierarchy."""
    for line in (proc / 'mountinfo').read_text(encoding='utf-8').splitlines():
        own, _, general = line.partition(' - ')
        kind, _, options = general.split(maxsplit=2)
        if (kind, controller) == ('cgroup2', '') or (
            kind == 'cgroup' and controller in options.split(',')
        ):
            root, where = own.split()[3:5]
            yield root, where.replace(r'\040', ' ')


def reachable_folders(proc: Path, path: str, controller: str) -> list[Path]:
    """Return the folders through which a cgroup can be reached."""
    inside = [(os.path.relpath(path, root), where) for root, where in _mounts(proc, controller)]
    return [Path(where, below) for below, where in inside if not below.startswith('..')]
