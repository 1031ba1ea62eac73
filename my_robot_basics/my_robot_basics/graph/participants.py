"""The DDS participants of this machine in a ROS domain, according to the operating system.

The RTPS standard numbers the ports: participant n of a domain listens for announcements on
7400 + 250 · domain + 10 + 2 · n.
"""

import os
from pathlib import Path

SOCKETS = Path('/proc/net/udp')
OWN_FILES = Path('/proc/self/fd')
_FIRST_PORT, _PORTS_A_DOMAIN, _OFFSET, _PORTS_A_PARTICIPANT = 7400, 250, 10, 2


def count(domain_id: int) -> int:
    """The number of participants in the domain, of all processes; 0 if it cannot be known."""
    return len(ports(domain_id))


def ports(domain_id: int) -> set[int]:
    """The ports on which participants listen for announcements; empty if they cannot be known."""
    return set(_inodes(domain_id))


def own_ports(domain_id: int) -> set[int]:
    """The ports of the participants in this process."""
    own = set(_open_sockets())
    return {port for port, inode in _inodes(domain_id).items() if inode in own}


def _inodes(domain_id: int) -> dict[int, str]:
    """The participants' ports, each with the inode of its socket."""
    try:
        lines = SOCKETS.read_text(encoding='ascii').splitlines()[1:]
    except OSError:
        return {}
    start = _FIRST_PORT + _PORTS_A_DOMAIN * domain_id
    listening = range(start + _OFFSET, start + _PORTS_A_DOMAIN, _PORTS_A_PARTICIPANT)
    found = {}
    for fields in map(str.split, lines):
        port = int(fields[1].rpartition(':')[2], 16)
        if port in listening:
            found[port] = fields[9]
    return found


def _open_sockets() -> list[str]:
    found = []
    for file in OWN_FILES.iterdir():
        try:
            target = os.readlink(file)
        except OSError:  # another thread has closed it meanwhile
            continue
        if target.startswith('socket:['):
            found.append(target[len('socket:[') : -1])
    return found
