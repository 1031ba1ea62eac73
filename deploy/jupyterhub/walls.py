"""What a room of a student is made of: the arguments of bubblewrap."""

from dataclasses import dataclass
from pathlib import Path

HIDDEN = ('/tmp', '/var/tmp', '/run')
"""Folders in which programs of all users leave files and sockets: each room has empty ones."""


@dataclass(frozen=True)
class Room:
    """What a student's server may see of the machine beside the read-only system."""

    home: Path
    """Theirs; the homes of others, which lie beside it, are hidden."""
    exchange: Path
    """nbgrader's: whose files are whose there, Linux decides."""
    shown: tuple[Path, ...]
    """Read-only, wherever they lie: the course, the hub's socket, the configuration."""


def bubblewrap(room: Room, *, tell: int) -> list[str]:
    """Return the command that runs what follows it in a room, as its process 1.

    bwrap writes to the descriptor `tell` which process that is outside. Raises ValueError where
    homes are no folders beside each other, as `/home/ada` and `/home/bob` are.
    """
    homes = room.home.parent
    if len(room.home.parts) < 3 or '..' in room.home.parts:
        raise ValueError(
            f'a home is {room.home}, expected a folder in one for homes, such as /home/ada: make '
            'each student one with useradd --create-home'
        )
    words = ['bwrap', '--as-pid-1', '--info-fd', str(tell)]
    # its network has only `lo`, on which ROS's nodes meet: nobody else's are there
    words += ['--unshare-user', '--unshare-net', '--unshare-pid', '--unshare-ipc', '--unshare-uts']
    words += ['--ro-bind', '/', '/', '--dev', '/dev', '--proc', '/proc']
    for folder in (*HIDDEN, str(homes)):
        words += ['--tmpfs', folder]
    for path in map(str, (room.home, room.exchange)):
        words += ['--bind', path, path]
    for path in map(str, room.shown):
        words += ['--ro-bind', path, path]
    return [*words, '--chdir', str(room.home), '--']
