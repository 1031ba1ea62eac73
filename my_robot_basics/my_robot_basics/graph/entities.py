"""Which nodes and endpoints each ROS participant says that it has.

They say so on the DDS topic `ros_discovery_info`, latched: there is a
`rmw_dds_common/msg/ParticipantEntitiesInfo` of each.
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
    """What one participant has."""

    nodes: frozenset[tuple[str, str]]
    """Name and namespace of each node."""
    endpoints: frozenset[bytes]
    """Identifiers of its nodes' publishers and subscriptions, those of services included."""


class Reader:
    """Reads what all participants say, for the duration of a with statement."""

    def __init__(self, node: Node) -> None:
        self._subscription = LatchedSubscription(
            node, TOPIC, package=_PACKAGE, message_name=_MESSAGE_NAME
        )
        self._said: dict[bytes, Entities] = {}

    def __enter__(self) -> 'Reader':
        """Go on."""
        return self

    def __exit__(self, *_: object) -> None:
        """Stop reading."""
        self._subscription.close()

    def read(self) -> dict[bytes, Entities]:
        """What each participant has said last, by its identifier."""
        while (message := self._subscription.take()) is not None:
            with contextlib.suppress(ValueError):  # whoever it is that speaks so
                participant, entities = parse(message)
                self._said[participant] = entities
        return dict(self._said)


def parse(message: bytes) -> tuple[bytes, Entities]:
    """A serialized ParticipantEntitiesInfo: the participant's identifier, and what it has.

    Raises ValueError if it is none.
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
    """Takes values one by one from a message in CDR, in which numbers are aligned."""

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
