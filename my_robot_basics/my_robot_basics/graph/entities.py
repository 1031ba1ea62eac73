"""Which nodes and endpoints each ROS participant announces.

Each participant publishes them on the latched DDS topic `ros_discovery_info`, as a
`rmw_dds_common/msg/ParticipantEntitiesInfo`.
"""

import contextlib
from dataclasses import dataclass
from typing import Literal

from rclpy.node import Node

from my_robot_basics.graph.rmw import LatchedSubscription

TOPIC = 'ros_discovery_info'
_PACKAGE, _MESSAGE_NAME = 'rmw_dds_common', 'ParticipantEntitiesInfo'
_GID_BYTES = 16


@dataclass(frozen=True)
class Entities:
    """The nodes and endpoints of one participant."""

    nodes: frozenset[tuple[str, str]]
    """Name and namespace of each node."""
    endpoints: frozenset[bytes]
    """GIDs of its nodes' publishers and subscriptions, including those of services."""


class Reader:
    """Reads the announcements of all participants, for the duration of a with statement."""

    def __init__(self, node: Node) -> None:
        self._subscription = LatchedSubscription(
            node, TOPIC, package=_PACKAGE, message_name=_MESSAGE_NAME
        )
        self._said: dict[bytes, Entities] = {}

    def __enter__(self) -> 'Reader':
        """Return this reader."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the subscription."""
        self._subscription.close()

    def read(self) -> dict[bytes, Entities]:
        """The latest announcement of each participant, by the participant's GID."""
        while (message := self._subscription.take()) is not None:
            with contextlib.suppress(ValueError):  # ignore what a foreign program publishes here
                participant, entities = parse(message)
                self._said[participant] = entities
        return dict(self._said)


def parse(message: bytes) -> tuple[bytes, Entities]:
    """Parse a serialized ParticipantEntitiesInfo: the participant's GID, and its entities.

    Raises ValueError if the message is too short.
    """
    reading = _Reading(message)
    participant = reading.gid()
    nodes: set[tuple[str, str]] = set()
    endpoints: set[bytes] = set()
    for _ in range(reading.count()):
        namespace, name = reading.string(), reading.string()
        nodes.add((name, namespace))
        for _readers_then_writers in range(2):
            endpoints.update([reading.gid() for _ in range(reading.count())])
    return participant, Entities(frozenset(nodes), frozenset(endpoints))


class _Reading:
    """Reads values one after the other from a message in CDR, which aligns numbers to 4 bytes."""

    def __init__(self, message: bytes) -> None:
        self._order: Literal['little', 'big'] = 'little' if message[1:2] == b'\1' else 'big'
        self._data = message[4:]
        self._at = 0

    def count(self) -> int:
        self._at += -self._at % 4
        return int.from_bytes(self._take(4), self._order)

    def string(self) -> str:
        return self._take(self.count()).rstrip(b'\0').decode(errors='replace')

    def gid(self) -> bytes:
        return self._take(_GID_BYTES)

    def _take(self, length: int) -> bytes:
        taken = self._data[self._at : self._at + length]
        if len(taken) < length:
            raise ValueError(f'the message ends at {len(self._data)} bytes')
        self._at += length
        return taken
