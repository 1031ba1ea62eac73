"""Lessons that run on this machine: each tells of itself, so that a terminal can join it.

What a kernel tells is the name of an abstract Unix socket, which is gone with the kernel, however
that dies. Imports nothing that is slow.
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
"""The name of a socket has room for 107 bytes in all."""

_announcement: socket.socket | None = None


@dataclass(frozen=True, order=True)
class RunningLesson:
    """A notebook whose kernel takes part in ROS."""

    started_nsec: int
    """When it joined its ROS domain, since the epoch."""
    domain_id: int
    pid: int
    """Of its kernel."""
    name: str
    """Of the notebook, or of its folder where the notebook's is not known."""


def announce(domain_id: int) -> None:
    """Tell other processes of the lesson in this kernel, until it ends."""
    global _announcement
    opened = os.environ.get('JPY_SESSION_NAME')  # JupyterLab's word for the notebook's path
    name = Path(opened).stem if opened else Path.cwd().name
    name = re.sub(r'[^\w-]', '_', name, flags=re.ASCII)[:_LONGEST_NAME] or 'notebook'
    _announcement = domain.hold(f'{_PREFIX}.{domain_id}.{time.time_ns()}.{os.getpid()}.{name}')


def running() -> list[RunningLesson]:
    """The lessons of this user on this machine, the one that started last comes last."""
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
    """Other users of this machine take the same course."""
    try:
        return Path('/proc', str(pid)).stat().st_uid == os.getuid()
    except OSError:
        return False
