"""Collects the evidence on a topic: the graph, nodes' answers, messages, and other domains."""

import dataclasses
import time
from collections.abc import Callable, Iterator

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from my_robot_basics.doctor import remaps
from my_robot_basics.doctor.asking import Questions
from my_robot_basics.doctor.evidence import Endpoint, Evidence, Kind, ReceivedMessage
from my_robot_basics.doctor.inside import Inside
from my_robot_basics.graph import graphs, participants
from my_robot_basics.graph.message_info import with_info
from my_robot_basics.graph.snapshot import PLUMBING, GraphSnapshot
from my_robot_basics.graph.watcher import HIDDEN, Watcher
from my_robot_basics.ros2.interfaces import message_class
from my_robot_basics.session import domain
from my_robot_basics.session.neighbours import nodes_here

LISTEN_SEC = 6.0
"""How long to wait for messages at most."""
ENOUGH_MESSAGES, ENOUGH_SEC = 4, 2.0
"""The look ends after this many messages, and this long after the first of them was sent."""
MISSING_SEC = 4.0
"""How long to wait for participants that Linux shows and the graph does not have yet."""
DOMAINS = (*range(domain.LAST + 1), *range(215, 233))
"""Domains whose ports are outside of Linux's range of ephemeral ports."""
DEPTH = 5000
"""Depth of the doctor's own queue: more messages than it can receive in one look."""
ANNOUNCEMENTS = 'ros_discovery_info'
"""DDS topic on which each ROS participant publishes the names of its nodes."""


def other_domains(domain_id: int) -> Iterator[int]:
    """Yield the other domains that are in use on this machine."""
    return (other for other in DOMAINS if other != domain_id and participants.count(other))


def look(
    watcher: Watcher, graph: GraphSnapshot, topic_name: str, *, domain_id: int, listen_sec: float
) -> Evidence:
    """Return the evidence on a topic, from a watcher that has taken the graph."""
    if not (graph.publishers(topic_name) and graph.subscriptions(topic_name)):
        # wait before an end is reported as missing
        watcher.spin_until(
            lambda: missing_participants(watcher.node, domain_id) <= 0, timeout_sec=MISSING_SEC
        )
        graph = graphs.take_snapshot(watcher)
    endpoints = tuple(endpoints_of(watcher.node))
    ends = {end.node_name for end in endpoints if end.name == topic_name}
    evidence = Evidence(
        name=topic_name,
        endpoints=endpoints,
        nodes={},
        has_clock=bool(watcher.node.get_publishers_info_by_topic('/clock')),
        remaps=remaps.remaps_in_domain(domain_id),
        domain_id=domain_id,
        missing_participants=missing_participants(watcher.node, domain_id),
    )
    view = Inside()
    view.look()
    questions = Questions(watcher, sorted(ends))
    if evidence.publishers:
        evidence = _listen(watcher, evidence, listen_sec=listen_sec)
    answers = dict.fromkeys(graph.nodes(), questions.UNASKED) | questions.answers()
    view.look()
    return dataclasses.replace(evidence, nodes=answers, callbacks=view.lasting())


def _listen(watcher: Watcher, evidence: Evidence, *, listen_sec: float) -> Evidence:
    """Subscribe with a QoS profile compatible with every publisher, and keep the messages."""
    classes = {end.type_name: message_class(end.type_name) for end in evidence.publishers}
    unknown = tuple(sorted(name for name, class_ in classes.items() if class_ is None))
    evidence = dataclasses.replace(evidence, unknown_types=unknown)
    type_ = next(filter(None, classes.values()), None)
    if type_ is None:
        return evidence
    received: list[ReceivedMessage] = []
    offers = [end.qos_profile for end in evidence.publishers]
    reliable = all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
    keeping = all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
    qos_profile = QoSProfile(
        depth=DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if keeping else DurabilityPolicy.VOLATILE,
    )
    start_sec, started = time.time(), time.monotonic()

    def receive(message: object, info: dict) -> None:
        received.append(ReceivedMessage(message=message, sent_sec=info['source_timestamp'] / 1e9))

    def is_enough() -> bool:
        fresh = [each for each in received if each.sent_sec >= start_sec]
        if len(fresh) < ENOUGH_MESSAGES:
            return False
        return time.time() - fresh[0].sent_sec >= ENOUGH_SEC

    watcher.node.create_subscription(type_, evidence.name, with_info(receive), qos_profile)
    watcher.spin_until(is_enough, timeout_sec=listen_sec)
    return dataclasses.replace(
        evidence,
        received=tuple(sorted(received, key=lambda each: each.sent_sec)),
        listened_sec=time.monotonic() - started,
        start_sec=start_sec,
    )


def endpoints_of(node: Node) -> Iterator[Endpoint]:
    """Yield all endpoints on the graph, except ROS's own topics' and hidden nodes'."""
    depths = _depths()
    look_ups: dict[Kind, Callable[[str], list[TopicEndpointInfo]]] = {
        'publisher': node.get_publishers_info_by_topic,
        'subscription': node.get_subscriptions_info_by_topic,
    }
    for topic_name, _ in node.get_topic_names_and_types():
        if topic_name in PLUMBING:
            continue
        for kind, look_up in look_ups.items():
            for info in look_up(topic_name):
                if info.node_name.startswith(HIDDEN):
                    continue
                node_name = graphs.full_name(info)
                yield Endpoint(
                    kind=kind,
                    node_name=node_name,
                    name=topic_name,
                    type_name=info.topic_type,
                    qos_profile=info.qos_profile,
                    depth=depths.get((kind, node_name, topic_name)),
                )


def _depths() -> dict[tuple[Kind, str, str], int]:
    """Return the depths of queues in this process; of several on one topic, the smallest."""
    found: dict = {}
    for node in nodes_here():
        name = node.get_fully_qualified_name()
        for kind, ends in ('publisher', node.publishers), ('subscription', node.subscriptions):
            for end in ends:
                key = kind, name, end.topic_name
                found[key] = min(end.qos_profile.depth, found.get(key, end.qos_profile.depth))
    return found


def missing_participants(node: Node, domain_id: int) -> int:
    """Return how many participants of the domain on this machine are not on the graph."""
    received = node.get_publishers_info_by_topic(ANNOUNCEMENTS, no_mangle=True)
    return participants.count(domain_id) - len(received)
