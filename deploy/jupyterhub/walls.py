"""The arguments of bubblewrap for a student's room."""

from dataclasses import dataclass
from pathlib import Path

HIDDEN = ('/tmp', '/var/tmp', '/run')
"""Folders in which programs of all users leave files and sockets: in a room they are empty."""


@dataclass(frozen=True)
class Room:
    """What a student's server may see of the machine besides the read-only system."""

    home: Path
    """The student's own home; the other homes in its parent folder are hidden."""
    exchange: Path
    """nbgrader's exchange: Linux permissions separate the users' files in it."""
    shown: tuple[Path, ...]
    """Read-only, at any path: the course, the hub's socket, the configuration."""


def bubblewrap(room: Room, *, tell: int) -> list[str]:
    """Return the beginning of a command that runs the rest in a room, as its process 1.

    bwrap writes that process's ID outside the room to the descriptor `tell`. Raises ValueError
    unless homes are folders in a common parent, such as `/home/ada` and `/home/bob`.
    """
    homes = room.home.parent
    if len(room.home.parts) < 3 or '..' in room.home.parts:
        raise ValueError(
            f'a home is {room.home}, expected a folder in one for homes, such as /home/ada: make '
            'each student one with useradd --create-home'
        )
    words = ['bwrap', '--as-pid-1', '--info-fd', str(tell)]
    # its network has only `lo`, so ROS nodes find only the student's own nodes
    words += ['--unshare-user', '--unshare-net', '--unshare-pid', '--unshare-ipc', '--unshare-uts']
    words += ['--ro-bind', '/', '/', '--dev', '/dev', '--proc', '/proc']
    for folder in (*HIDDEN, str(homes)):
        words += ['--tmpfs', folder]
    for path in map(str, (room.home, room.exchange)):
        words += ['--bind', path, path]
    for path in map(str, room.shown):
        words += ['--ro-bind', path, path]
    return [*words, '--chdir', str(room.home), '--']
