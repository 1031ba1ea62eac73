"""When the graph has settled: everybody is on it, with a name.

The operating system tells how many participants there are on this machine, so that nobody has to
sleep in case there are more.
"""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

from my_robot_basics.graph import participants
from my_robot_basics.ros2 import environment

if TYPE_CHECKING:
    from rclpy.node import Node

UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""rclpy's word while it knows an endpoint, and not yet its node."""
ANNOUNCEMENTS = 'ros_discovery_info'
"""DDS topic on which each ROS participant publishes the names of its nodes."""

POLL_SEC = 0.01
COMPLETE_SEC = 0.05
"""A graph with everybody on it counts as settled when it has not changed for so long."""
INCOMPLETE_SEC = 1.0
"""… and so long while somebody is still missing, who may have nothing to say to ROS."""
NETWORK_SEC = 0.5
"""Other machines have so long to answer: ros2cli's own time."""
MOST_SEC = 5.0


def settle(node: 'Node', wait: Callable[[float], None]) -> None:
    """Wait, by `wait` with a time in seconds, until the graph that a node sees has settled."""
    started = changed = time.monotonic()
    last = _look(node)
    while (now := time.monotonic()) < started + MOST_SEC:
        waited_enough = environment.hears_this_machine_only() or now >= started + NETWORK_SEC
        quiet_sec = COMPLETE_SEC if last.is_complete() else INCOMPLETE_SEC
        if waited_enough and now >= changed + quiet_sec:
            return
        wait(POLL_SEC)
        if (look := _look(node)) != last:
            last, changed = look, time.monotonic()


class _Look(NamedTuple):
    """The graph in a form to compare."""

    participants: int
    """Those that have announced themselves to us."""
    ends: list[tuple[str, bytes]]
    """The name of its node, and the identifier, of each publisher and subscription."""
    topics: list[tuple[str, list[str]]]
    nodes: list[tuple[str, str]]

    def is_complete(self) -> bool:
        present = participants.count(environment.domain_id())
        named = all(node_name != UNKNOWN for node_name, _ in self.ends)
        return named and self.participants >= present


def _look(node: 'Node') -> _Look:
    topics = node.get_topic_names_and_types()
    look_ups = node.get_publishers_info_by_topic, node.get_subscriptions_info_by_topic
    infos = [info for name, _ in topics for look_up in look_ups for info in look_up(name)]
    return _Look(
        participants=len(node.get_publishers_info_by_topic(ANNOUNCEMENTS, no_mangle=True)),
        ends=[(info.node_name, bytes(info.endpoint_gid)) for info in infos],
        topics=topics,
        nodes=node.get_node_names_and_namespaces(),
    )
