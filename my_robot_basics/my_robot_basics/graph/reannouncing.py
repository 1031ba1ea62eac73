"""Ask the DDS participants of this machine to announce themselves again.

Fast DDS sends a first announcement before it listens for replies. Another participant replies
once, immediately; if that reply is lost, its next announcement comes up to 3 s later. But a
participant replies to every new one. So this module announces an invented participant with the
address of an existing one: the reply arrives there.
"""

import os
import socket
import struct
from collections.abc import Iterable

from my_robot_basics.graph import participants

LOOPBACK = '127.0.0.1'
LEASE_SEC = 1
"""How long other participants remember the invented one."""

# numbers of the RTPS standard, version 2.3
_VERSION, _NO_VENDOR = bytes([2, 3]), bytes(2)
_PARTICIPANT, _ANNOUNCER = bytes([0, 0, 1, 0xC1]), bytes([0, 1, 0, 0xC2])
_DATA, _LITTLE_ENDIAN_WITH_DATA, _BYTES_TO_QOS = 0x15, 0x05, 16
_PARAMETERS_LITTLE_ENDIAN = bytes([0, 3, 0, 0])
_UDP_V4 = 1
_ANNOUNCES_AND_DETECTS = 3
_LEASE, _PROTOCOL_VERSION, _VENDOR, _GUID = 0x02, 0x15, 0x16, 0x50
_UNICAST, _METATRAFFIC_UNICAST, _ENDPOINTS, _END = 0x31, 0x32, 0x58, 0x01


def ask(domain_id: int) -> None:
    """Ask all participants of this machine in the ROS domain to announce themselves here."""
    own = participants.own_ports(domain_id)
    others = participants.ports(domain_id) - own
    for port in own:
        ask_ports(others, reply_port=port)


def ask_ports(ports: Iterable[int], *, reply_port: int) -> None:
    """Ask the participants that listen on `ports` to announce themselves to `reply_port`."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for port in ports:
            sender.sendto(announcement(os.urandom(12), reply_port), (LOOPBACK, port))


def announcement(guid_prefix: bytes, reply_port: int) -> bytes:
    """An RTPS message that announces a participant at a port of this machine.

    `guid_prefix` (12 bytes) identifies the participant. It announces no endpoints except those
    for discovering participants.
    """
    address = struct.pack('<iI12x', _UDP_V4, reply_port) + socket.inet_aton(LOOPBACK)
    parameters = {
        _PROTOCOL_VERSION: _VERSION + bytes(2),
        _VENDOR: _NO_VENDOR + bytes(2),
        _GUID: guid_prefix + _PARTICIPANT,
        _METATRAFFIC_UNICAST: address,
        _UNICAST: address,
        _LEASE: struct.pack('<iI', LEASE_SEC, 0),
        _ENDPOINTS: struct.pack('<I', _ANNOUNCES_AND_DETECTS),
        _END: b'',
    }
    payload = _PARAMETERS_LITTLE_ENDIAN + b''.join(
        struct.pack('<HH', name, len(value)) + value for name, value in parameters.items()
    )
    to_anybody, sequence_number = bytes(4), struct.pack('<iI', 0, 1)
    body = struct.pack('<HH', 0, _BYTES_TO_QOS) + to_anybody + _ANNOUNCER + sequence_number
    body += payload
    head = b'RTPS' + _VERSION + _NO_VENDOR + guid_prefix
    return head + struct.pack('<BBH', _DATA, _LITTLE_ENDIAN_WITH_DATA, len(body)) + body
