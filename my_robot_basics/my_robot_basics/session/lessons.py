"""Lessons that run on this machine: each announces itself, so that a terminal can join it.

The announcement is the name of an abstract Unix socket, which disappears with the kernel,
however that ends. Imports nothing that is slow.
"""

import os
import re
import socket
import time
from dataclasses import dataclass
from pathlib import Path

from my_robot_basics.session import domain

SOCKETS = Path('/proc/net/unix')
_PREFIX = 'my_robot_basics.lesson'
_ROW = re.compile(rf' @{re.escape(_PREFIX)}\.(\d+)\.(\d+)\.(\d+)\.([\w-]+)$', re.ASCII)
_LONGEST_NAME = 40
"""Characters; the whole name of a socket has at most 107 bytes."""

_announcement: socket.socket | None = None


@dataclass(frozen=True, order=True)
class RunningLesson:
    """A notebook whose kernel takes part in ROS."""

    started_nsec: int
    """When it joined its ROS domain, in ns since the epoch."""
    domain_id: int
    pid: int
    """Process ID of its kernel."""
    name: str
    """Name of the notebook, or of its folder if the notebook's is unknown."""


def announce(domain_id: int) -> None:
    """Announce the lesson in this kernel to other processes, until the kernel ends."""
    global _announcement
    opened = os.environ.get('JPY_SESSION_NAME')  # the notebook's path, set by JupyterLab
    name = Path(opened).stem if opened else Path.cwd().name
    name = re.sub(r'[^\w-]', '_', name, flags=re.ASCII)[:_LONGEST_NAME] or 'notebook'
    _announcement = domain.bind_abstract_socket(
        f'{_PREFIX}.{domain_id}.{time.time_ns()}.{os.getpid()}.{name}'
    )


def running() -> list[RunningLesson]:
    """Return this user's lessons on this machine, the one that started last at the end."""
    try:
        rows = SOCKETS.read_text(encoding='ascii', errors='replace').splitlines()
    except OSError:
        return []
    found = []
    for row in rows:
        if match := _ROW.search(row):
            domain_id, started_nsec, pid = map(int, match.groups()[:3])
            found.append(RunningLesson(started_nsec, domain_id, pid, match[4]))
    return sorted(lesson for lesson in found if _is_ours(lesson.pid))


def _is_ours(pid: int) -> bool:
    """Whether it is a process of this user: others on this machine may take the course, too."""
    try:
        return Path('/proc', str(pid)).stat().st_uid == os.getuid()
    except OSError:
        return False
