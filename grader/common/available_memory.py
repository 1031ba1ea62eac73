"""How much memory is available, on the machine and in the container around the grader."""

from pathlib import Path

import psutil


def available_bytes(cgroup: Path = Path('/sys/fs/cgroup')) -> int:
    """Return what the machine has available, or what the container has, if that is less."""
    left = psutil.virtual_memory().available
    try:
        most = int((cgroup / 'memory.max').read_text('ascii'))
        used = int((cgroup / 'memory.current').read_text('ascii'))
        lines = (cgroup / 'memory.stat').read_text('ascii').splitlines()
    except (OSError, ValueError):  # not in a container, or in one without a limit: 'max'
        return left
    cached = dict(line.split() for line in lines).get('inactive_file', 0)
    return max(0, min(left, most - used + int(cached)))
