"""The ROS graph for checks: the student's nodes, and which of them publish and subscribe."""

import time
from collections.abc import Callable

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from my_robot_basics.exchange import student
from my_robot_basics.graph import earlier_waits
from my_robot_basics.graph.snapshot import GraphSnapshot
from my_robot_basics.graph.watcher import HIDDEN, Watcher

SETTLE_SEC = 0.4
"""The graph counts as settled when it has not changed for this long."""
MOST_SETTLE_SEC = 5.0
"""How long `take_snapshot` waits for that at most, without the time to read the graph."""
MOST_TAKE_SEC = 15.0
"""The same with that time: on a busy machine, or with a large graph, reading takes longer."""
PUBLISHER_SEC = 10.0
NEWCOMER_SEC = 0.2
"""How long to wait for a second publisher after the first."""
MANY_NEWCOMERS = 5
"""If the publishers change this often, new ones keep coming: one is created for each message."""
SETTLED_SEC = 0.5
"""How long to wait for what the notebook does not have, if nothing in it can create more."""
SEEN_SEC = 3.0
"""How long the notebook's nodes may take to be discovered."""
UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""rmw's name for the node of an endpoint whose node it does not know yet (for about 20 ms)."""


def graph(*, after_publisher_on: str = '') -> GraphSnapshot:
    """The graph once it has settled: `graph().publishers('/chatter')`.

    `after_publisher_on`: a topic; first wait for a publisher on it, PUBLISHER_SEC at most.
    """
    with Watcher() as watcher:
        if after_publisher_on:
            wait_for_publisher(watcher, after_publisher_on, timeout_sec=PUBLISHER_SEC)
        return take_snapshot(watcher)


def take_snapshot(watcher: Watcher) -> GraphSnapshot:
    """The graph as a watcher sees it, once it has not changed for SETTLE_SEC and knows all names.

    After MOST_SETTLE_SEC or MOST_TAKE_SEC, the graph as it is then.
    """
    last = _read_graph(watcher.node)
    since, earlier = watcher.earlier_look
    if last == earlier and not _has_unknown(last) and time.monotonic() - since >= SETTLE_SEC:
        return last
    steady = 0.0
    waited = 0.0
    deadline = time.monotonic() + MOST_TAKE_SEC
    while (
        waited < MOST_SETTLE_SEC
        and (steady < SETTLE_SEC or _has_unknown(last))
        and time.monotonic() < deadline
    ):
        watcher.spin_for(0.05)
        waited += 0.05
        now = _read_graph(watcher.node)
        steady = steady + 0.05 if now == last else 0.0
        last = now
    return last


def publisher_infos(
    node: Node, topic_name: str, *, is_dds: bool = False
) -> list[TopicEndpointInfo]:
    """The publishers on a topic, without those of the course's own nodes.

    `is_dds`: the name is DDS's, such as 'rq/solve_ikRequest' for the requests of a service.
    """
    found = node.get_publishers_info_by_topic(topic_name, no_mangle=is_dds)
    return [info for info in found if not is_hidden(info)]


def subscription_infos(
    node: Node, topic_name: str, *, is_dds: bool = False
) -> list[TopicEndpointInfo]:
    """The subscriptions to a topic, without those of the course's own nodes.

    `is_dds`: the name is DDS's, such as 'rq/solve_ikRequest' for the requests of a service.
    """
    found = node.get_subscriptions_info_by_topic(topic_name, no_mangle=is_dds)
    return [info for info in found if not is_hidden(info)]


def full_name(info: TopicEndpointInfo) -> str:
    """The full name of an endpoint's node."""
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'


def wait_for_publisher(watcher: Watcher, topic_name: str, *, timeout_sec: float) -> bool:
    """Wait for a publisher on the topic, and then until no more come; return whether one exists.

    If a shared participant has seen the same publishers before, it does not wait for more. True
    also if new publishers come all the time (MANY_NEWCOMERS).
    """
    last: set = set()
    since, changes = time.monotonic(), 0

    def is_settled() -> bool:
        nonlocal last, since, changes
        now = {
            (info.node_name, info.topic_type, *info.endpoint_gid)
            for info in publisher_infos(watcher.node, topic_name)
        }
        if now != last:
            last, since, changes = now, time.monotonic(), changes + 1
        known = bool(now) and all(node_name != UNKNOWN for node_name, *_ in now)
        is_long = time.monotonic() - since >= NEWCOMER_SEC
        return known and (is_long or earlier_waits.is_known(watcher.context, topic_name, now))

    is_there = watcher.spin_until(is_settled, timeout_sec=timeout_sec)
    if is_there:
        earlier_waits.remember(watcher.context, topic_name, last)
    return is_there or (bool(last) and changes >= MANY_NEWCOMERS)


def is_settled(watcher: Watcher, node_name: str = '') -> bool:
    """Whether the graph has all nodes of the notebook, and the notebook cannot create endpoints.

    False if one of the nodes is `node_name`: then the caller should wait for it as usual.
    """
    names = student.settled_nodes()
    if names is None or node_name in names:
        return False
    are_seen = watcher.spin_until(
        lambda: {*names} <= {*node_names(watcher.node)}, timeout_sec=SEEN_SEC
    )
    watcher.earlier_look = time.monotonic(), _read_graph(watcher.node)
    return are_seen


def none_in(seconds: float) -> str:
    """The words for something that did not come: 'none', after a longer wait with the time."""
    return 'none' if seconds <= SETTLED_SEC else f'none in {seconds:g} s'


def is_gone(watcher: Watcher, node_name: str) -> bool:
    """Whether no running node has that full name.

    A name on the graph is no proof of a node: it stays if rmw handles a participant's last message
    after its end. So the node must also publish on /parameter_events, as each node of rclpy does.
    """
    living = {full_name(info) for info in publisher_infos(watcher.node, '/parameter_events')}
    return node_name not in living or node_name not in node_names(watcher.node)


def _read_graph(node: Node) -> GraphSnapshot:
    names = set(node_names(node))
    topic_names = [name for name, _ in node.get_topic_names_and_types()]
    return GraphSnapshot(
        node_names=tuple(sorted(names)),
        publisher_names=_endpoints(topic_names, node.get_publishers_info_by_topic),
        subscription_names=_endpoints(topic_names, node.get_subscriptions_info_by_topic),
    )


def node_names(node: Node) -> list[str]:
    """Full names of the nodes on the graph, without the course's own."""
    return [
        f'{namespace.rstrip("/")}/{name}'
        for name, namespace in node.get_node_names_and_namespaces()
        if not name.startswith(HIDDEN)
    ]


def _endpoints(
    topic_names: list[str], look_up: Callable[[str], list[TopicEndpointInfo]]
) -> dict[str, tuple[str, ...]]:
    found = {
        name: tuple(sorted(full_name(info) for info in look_up(name) if not is_hidden(info)))
        for name in topic_names
    }
    return {name: nodes for name, nodes in found.items() if nodes}


def is_hidden(info: TopicEndpointInfo) -> bool:
    """Whether an endpoint belongs to a node whose name starts with `_`."""
    return info.node_name.startswith(HIDDEN) and info.node_name != UNKNOWN


def _has_unknown(picture: GraphSnapshot) -> bool:
    ends = [*picture.publisher_names.values(), *picture.subscription_names.values()]
    return any(name.endswith(UNKNOWN) for names in ends for name in names)
