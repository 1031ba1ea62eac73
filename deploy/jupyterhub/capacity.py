"""Compute how many servers fit into a machine's memory, so that the hub refuses more."""

from pathlib import Path

SYSTEM_MB = 1_500
"""Memory for Linux, the hub, the proxy and `./course serve` with its workers."""


def memory_mb(meminfo: Path = Path('/proc/meminfo')) -> int:
    """Return the machine's memory in MB."""
    lines = dict(line.split(':') for line in meminfo.read_text(encoding='ascii').splitlines())
    return int(lines['MemTotal'].split()[0]) // 1024


def servers_that_fit(total_mb: int, student_mb: int) -> int:
    """Return how many may run at a time. Raises ValueError if not even one fits."""
    fits = (total_mb - SYSTEM_MB) // student_mb
    if fits < 1:
        raise ValueError(
            f'this machine has {total_mb} MB of memory, expected {SYSTEM_MB} MB and {student_mb} '
            'MB for each student who works at the same time: give it more'
        )
    return fits
