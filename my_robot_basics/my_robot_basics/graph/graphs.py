"""The ROS graph as a check sees it: the student's nodes, and who publishes and subscribes."""

import difflib
import time
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from my_robot_basics.exchange import student
from my_robot_basics.feedback.hidden import raised as safely
from my_robot_basics.feedback.hidden import theirs
from my_robot_basics.graph.watcher import HIDDEN, Watcher

SETTLE_SEC = 0.4
"""The graph counts as settled when it has not changed for so long."""
MOST_SETTLE_SEC = 5.0
MOST_TAKE_SEC = 15.0
"""The same with the looks themselves: a busy machine, or a large graph, takes longer for each."""
PUBLISHER_SEC = 10.0
NEWCOMER_SEC = 0.2
"""How long to look out for a second publisher after the first."""
SETTLED_SEC = 0.5
"""How long to wait for what the notebook has not got, and nothing in it can make any more."""
SEEN_SEC = 3.0
"""How long the nodes that it has may take to be seen."""
UNKNOWN = '_NODE_NAME_UNKNOWN_'
"""rclpy's word while it knows an endpoint, and not yet its node (about 20 ms)."""
_PLUMBING = ('/clock', '/parameter_events', '/rosout')


@dataclass(frozen=True)
class Graph:
    """A picture of the graph, without the nodes whose names start with `_`."""

    node_names: tuple[str, ...]
    """Full names, such as `/kinematics_publisher`, sorted."""
    publisher_names: dict[str, tuple[str, ...]]
    """Topic name to the full names of the nodes that publish there, one for each publisher."""
    subscription_names: dict[str, tuple[str, ...]]
    """Topic name to the full names of the nodes that subscribe there."""

    def nodes(self) -> tuple[str, ...]:
        """Full names of the nodes, sorted."""
        return self.node_names

    def publishers(self, topic_name: str) -> tuple[str, ...]:
        """Full names of the nodes that publish on the topic, one for each publisher."""
        return self.publisher_names.get(topic_name, ())

    def subscriptions(self, topic_name: str) -> tuple[str, ...]:
        """Full names of the nodes that subscribe to the topic, one for each subscription."""
        return self.subscription_names.get(topic_name, ())

    def without(self, node_names: Collection[str]) -> 'Graph':
        """The same graph, had those nodes not been there."""

        def left(names: dict[str, tuple[str, ...]]) -> dict[str, tuple[str, ...]]:
            rest = {
                topic_name: tuple(node for node in nodes if node not in node_names)
                for topic_name, nodes in names.items()
            }
            return {topic_name: nodes for topic_name, nodes in rest.items() if nodes}

        return Graph(
            node_names=tuple(name for name in self.node_names if name not in node_names),
            publisher_names=left(self.publisher_names),
            subscription_names=left(self.subscription_names),
        )

    def why_silent(self, topic_name: str) -> str:
        """What to try when nothing arrives on a topic: one clause."""
        if senders := self.publishers(topic_name):
            who = theirs(', '.join(senders))
            if raised := what_raised(senders):
                return f'{who} has a publisher there and sends nothing, because {raised}'
            return (
                f'{who} has a publisher there and sends nothing, so see that it spins, that its '
                'timer is created (with a period in seconds, and the name of a method, without '
                'parentheses), and that no callback raises, or waits and so keeps the node busy'
            )
        others = self.subscriptions(topic_name)
        return self._why_none(topic_name, self.publisher_names, 'create_publisher', others)

    def why_unheard(self, topic_name: str) -> str:
        """What to try when nobody subscribes to a topic: one clause."""
        others = self.publishers(topic_name)
        return self._why_none(topic_name, self.subscription_names, 'create_subscription', others)

    def _why_none(
        self,
        topic_name: str,
        names: dict[str, tuple[str, ...]],
        maker: str,
        others: tuple[str, ...],
    ) -> str:
        # who is at the other end of the topic is not the one that is missing at this end
        runs = [name for name in self.node_names if name not in others]
        similar = _similar(topic_name, [name for name in names if name not in _PLUMBING])
        # it may be the one that was meant, with its two ends mixed up
        if mixed := sorted({*names.get(similar, others if not runs else ())} & {*others}):
            return (
                f'{theirs(", ".join(mixed))} is at the other end of this topic, so check the'
                f' name in {maker}(…); if another node is missing, run the cell that starts it'
            )
        if not runs:
            return 'the node is not running, so run the cell that starts it and read its output'
        if similar:
            uses = theirs(f'{", ".join(names[similar])} uses {similar}')
            if similar in {name.rpartition('/')[0] + topic_name for name in names[similar]}:
                return f"{uses}: a name without a leading / is relative to its node's namespace"
            return f'{uses}, so compare the spelling'
        if raised := what_raised(runs):
            return f'{theirs(", ".join(runs))} runs, and {raised}, so fix that first'
        look = f'look at the topic name in {maker}(…) and that the node calls it'
        if len(runs) == 1:
            return f'{theirs(runs[0])} runs, so {look}'
        return (
            f'{theirs(", ".join(runs))} run, so if yours is among them, {look}; if it is not, run'
            ' the cell that starts it and read what it says'
        )


def graph(*, after_publisher_on: str = '') -> Graph:
    """The graph as it is now, once it has settled: `graph().publishers('/chatter')`.

    With the name of a topic, once somebody publishes there, or after PUBLISHER_SEC.
    """
    with Watcher() as watcher:
        if after_publisher_on:
            wait_for_publisher(watcher, after_publisher_on, timeout_sec=PUBLISHER_SEC)
        return take(watcher)


def take(watcher: Watcher) -> Graph:
    """The graph as a watcher sees it, once no change came for a while and all names are known."""
    last = _look(watcher.node)
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
        now = _look(watcher.node)
        steady = steady + 0.05 if now == last else 0.0
        last = now
    return last


def publisher_infos(node: Node, topic_name: str) -> list[TopicEndpointInfo]:
    """The endpoints that publish on a topic; those of nodes of the course are left out."""
    return [info for info in node.get_publishers_info_by_topic(topic_name) if not _hidden(info)]


def subscription_infos(node: Node, topic_name: str) -> list[TopicEndpointInfo]:
    """The endpoints that subscribe to a topic; those of nodes of the course are left out."""
    return [info for info in node.get_subscriptions_info_by_topic(topic_name) if not _hidden(info)]


def full_name(info: TopicEndpointInfo) -> str:
    """The full name of an endpoint's node."""
    return f'{info.node_namespace.rstrip("/")}/{info.node_name}'


def wait_for_publisher(watcher: Watcher, topic_name: str, *, timeout_sec: float) -> bool:
    """Wait until somebody publishes on the topic, and no other publisher turns up for a moment."""
    last: set = set()
    since = time.monotonic()

    def is_settled() -> bool:
        nonlocal last, since
        now = {
            (info.node_name, info.topic_type, *info.endpoint_gid)
            for info in publisher_infos(watcher.node, topic_name)
        }
        if now != last:
            last, since = now, time.monotonic()
        known = bool(now) and all(node_name != UNKNOWN for node_name, *_ in now)
        return known and time.monotonic() - since >= NEWCOMER_SEC

    return watcher.spin_until(is_settled, timeout_sec=timeout_sec)


def is_settled(watcher: Watcher, node_name: str = '') -> bool:
    """Whether the graph has all nodes of the notebook, and no other endpoint of its can come.

    Nor a node of that name: they have none.
    """
    names = student.settled_nodes()
    if names is None or node_name in names:
        return False
    return watcher.spin_until(
        lambda: {*names} <= {*_node_names(watcher.node)}, timeout_sec=SEEN_SEC
    )


def none_in(seconds: float) -> str:
    """What was seen of what was waited for in vain."""
    return 'none' if seconds <= SETTLED_SEC else f'none in {seconds:g} s'


def what_raised(node_names: Iterable[str]) -> str:
    """A clause on the callback of one of the nodes that has raised, or ''."""
    said = next(filter(None, map(student.trouble, sorted(set(node_names)))), '')
    if not said:
        return ''
    why = f'its callback raised {safely(said)}'
    if said.endswith('object is not callable'):
        why += ', so give a method by its name, without parentheses'
    if "'Time' object has no attribute 'sec'" in said:
        why += ', so make a stamp of the time with .to_msg()'
    return why


def _look(node: Node) -> Graph:
    names = set(_node_names(node))
    topic_names = [name for name, _ in node.get_topic_names_and_types()]
    return Graph(
        node_names=tuple(sorted(names)),
        publisher_names=_endpoints(topic_names, node.get_publishers_info_by_topic),
        subscription_names=_endpoints(topic_names, node.get_subscriptions_info_by_topic),
    )


def _node_names(node: Node) -> list[str]:
    return [
        f'{namespace.rstrip("/")}/{name}'
        for name, namespace in node.get_node_names_and_namespaces()
        if not name.startswith(HIDDEN)
    ]


def _endpoints(
    topic_names: list[str], look_up: Callable[[str], list[TopicEndpointInfo]]
) -> dict[str, tuple[str, ...]]:
    found = {
        name: tuple(sorted(full_name(info) for info in look_up(name) if not _hidden(info)))
        for name in topic_names
    }
    return {name: nodes for name, nodes in found.items() if nodes}


def _hidden(info: TopicEndpointInfo) -> bool:
    return info.node_name.startswith(HIDDEN) and info.node_name != UNKNOWN


def _has_unknown(picture: Graph) -> bool:
    ends = [*picture.publisher_names.values(), *picture.subscription_names.values()]
    return any(name.endswith(UNKNOWN) for names in ends for name in names)


def _similar(topic_name: str, others: list[str]) -> str | None:
    last = topic_name.rpartition('/')[2]
    same_end = [name for name in others if name.rpartition('/')[2].lower() == last.lower()]
    close = difflib.get_close_matches(topic_name, others, n=1, cutoff=0.6)
    return next(iter([*same_end, *close]), None)
