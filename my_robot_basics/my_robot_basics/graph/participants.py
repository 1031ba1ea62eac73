"""How many DDS participants this machine has in a ROS domain, asked of the operating system."""

from pathlib import Path

SOCKETS = Path('/proc/net/udp')
# The RTPS standard's port numbers: participant n of a domain listens for announcements on
# 7400 + 250 · domain + 10 + 2 · n.
_FIRST_PORT, _PORTS_A_DOMAIN, _OFFSET, _PORTS_A_PARTICIPANT = 7400, 250, 10, 2


def count(domain_id: int) -> int:
    """Participants that listen in the domain now, of any process; 0 if that can't be known."""
    try:
        lines = SOCKETS.read_text(encoding='ascii').splitlines()[1:]
    except OSError:
        return 0
    ports = {int(line.split()[1].rpartition(':')[2], 16) for line in lines}
    start = _FIRST_PORT + _PORTS_A_DOMAIN * domain_id
    listening = range(start + _OFFSET, start + _PORTS_A_DOMAIN, _PORTS_A_PARTICIPANT)
    return len(ports.intersection(listening))
