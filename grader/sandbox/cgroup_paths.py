"""Where Linux says that a process's cgroups are, and where each can be found as a folder."""

import os
from collections.abc import Iterator
from pathlib import Path


def own_paths(proc: Path) -> dict[str, str]:
    """Return the cgroup of this process by controller; that of version 2 by ''."""
    lines = (proc / 'cgroup').read_text(encoding='utf-8').splitlines()
    whole = [line.split(':', 2) for line in lines]
    return {name: path for _, names, path in whole for name in names.split(',')}


def _mounts(proc: Path, controller: str) -> Iterator[tuple[str, str]]:
    """Yield which part of a controller's hierarchy is mounted, and where."""
    for line in (proc / 'mountinfo').read_text(encoding='utf-8').splitlines():
        own, _, general = line.partition(' - ')
        kind, _, options = general.split(maxsplit=2)
        if (kind, controller) == ('cgroup2', '') or (
            kind == 'cgroup' and controller in options.split(',')
        ):
            root, where = own.split()[3:5]
            yield root, where.replace(r'\040', ' ')


def holds(proc: Path, path: str, controller: str) -> list[Path]:
    """Return the folders at which a cgroup is mounted."""
    inside = [(os.path.relpath(path, root), where) for root, where in _mounts(proc, controller)]
    return [Path(where, below) for below, where in inside if not below.startswith('..')]
