"""When the graph has settled: everybody is on it, with all that they say they have.

The operating system tells how many participants there are on this machine, and each of these says
which nodes and endpoints it has: so nobody has to sleep in case there are more.
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
"""rclpy's word while it knows an endpoint, and not yet its node."""

POLL_SEC = 0.01
COMPLETE_SEC = 0.05
"""A graph with everybody on it counts as settled when it has not changed for so long."""
INCOMPLETE_SEC = 2.0
"""… and so long while a participant is still missing, which may have no nodes at all."""
FIRST_PAUSE_SEC = 0.05
"""Between two times that all are asked to announce themselves; each pause is twice the last."""
NETWORK_SEC = 0.5
"""Other machines have so long to answer: ros2cli's own time."""
MOST_SEC = 5.0

_ROS_PREFIXES = ('rt/', 'rq/', 'rr/')
"""Of the DDS names of ROS topics, and of the two topics of a service."""


def settle(node: 'Node', wait: Callable[[float], None], *, domain_id: int | None = None) -> None:
    """Wait, by `wait` with a time in seconds, until the graph that a node sees has settled.

    The node is in the ROS domain of that ID; by default in the environment's.
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
    """The graph in a form to compare."""

    said: 'Mapping[bytes, Entities]'
    """What each participant says that it has."""
    ends: set[bytes]
    """Identifiers of all publishers and subscriptions, those of services included."""
    nameless: set[bytes]
    """Those whose node is not known yet."""
    nodes: set[tuple[str, str]]

    def is_complete(self, present: int) -> bool:
        """Whether so many participants have spoken, and all that they have is there."""
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
