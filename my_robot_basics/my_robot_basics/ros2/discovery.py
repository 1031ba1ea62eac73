"""Wait until the graph has settled: all participants are on it with all their nodes and endpoints.

Linux shows how many participants this machine has, and each of them announces its nodes and
endpoints. So no fixed time has to be waited for in case there are more.
"""

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

from my_robot_basics.graph import participants, reannouncing
from my_robot_basics.ros2 import environment

if TYPE_CHECKING:
    from rclpy.node import Node

    from my_robot_basics.graph.entities import Entities

UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""rclpy's name for the node of an endpoint while that node is unknown."""

POLL_SEC = 0.01
COMPLETE_SEC = 0.05
"""A complete graph counts as settled if it has not changed for this long."""
INCOMPLETE_SEC = 2.0
"""The same if a participant is still missing, which may have no nodes at all."""
FIRST_PAUSE_SEC = 0.05
"""The first pause between requests to announce again; each pause is twice the one before."""
NETWORK_SEC = 0.5
"""How long to wait for other machines, as ros2cli does."""
MOST_SEC = 5.0

_ROS_PREFIXES = ('rt/', 'rq/', 'rr/')
"""Prefixes of the DDS names of ROS topics, and of the two topics of a service."""


def settle(node: 'Node', wait: Callable[[float], None], *, domain_id: int | None = None) -> None:
    """Wait until the graph that a node sees has settled; `wait` gets a time in seconds to wait.

    The node is in the ROS domain `domain_id`; by default in that of the environment.
    """
    from my_robot_basics.graph import entities

    if domain_id is None:
        domain_id = environment.domain_id()
    with entities.Reader(node) as reader:
        started = changed = asked = time.monotonic()
        pause_sec = 0.0
        last = None
        while (now := time.monotonic()) < started + MOST_SEC:
            present = participants.count(domain_id)
            if (look := _look(node, reader.read())) != last:
                last, changed = look, now
            quiet_sec = COMPLETE_SEC if look.is_complete(present) else INCOMPLETE_SEC
            waited_enough = environment.is_localhost_only() or now >= started + NETWORK_SEC
            if waited_enough and now >= changed + quiet_sec:
                return
            if len(look.said) < present and now >= asked + pause_sec:
                reannouncing.ask(domain_id)
                asked, pause_sec = now, 2 * pause_sec or FIRST_PAUSE_SEC
            wait(POLL_SEC)


class _Look(NamedTuple):
    """The graph in a form that can be compared."""

    said: 'Mapping[bytes, Entities]'
    """The nodes and endpoints that each participant has announced."""
    ends: set[bytes]
    """GIDs of all publishers and subscriptions, including those of services."""
    nameless: set[bytes]
    """GIDs of endpoints whose node is not known yet."""
    nodes: set[tuple[str, str]]

    def is_complete(self, present: int) -> bool:
        """Whether so many participants have announced themselves and are completely discovered."""
        return (
            len(self.said) >= present
            and not self.nameless
            and all(
                each.endpoints <= self.ends and each.nodes <= self.nodes
                for each in self.said.values()
            )
        )


def _look(node: 'Node', said: 'Mapping[bytes, Entities]') -> _Look:
    ends, nameless = set(), set()
    look_ups = node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic
    for name, _ in node.get_topic_names_and_types(no_demangle=True):
        for info in [info for look_up in look_ups for info in look_up(name, no_mangle=True)]:
            ends.add(gid := bytes(info.endpoint_gid))
            if info.node_name == UNKNOWN and name.startswith(_ROS_PREFIXES):
                nameless.add(gid)
    return _Look(said, ends, nameless, set(node.get_node_names_and_namespaces()))
