"""Looks at a name, whether it is a topic's or a service's, and judges what is seen."""

import dataclasses
from collections.abc import Callable, Iterable
from typing import NamedTuple

from rclpy.node import Node

from my_robot_basics.doctor import looking, rules, service_looking, service_rules
from my_robot_basics.doctor.evidence import Diagnosis, Endpoint
from my_robot_basics.doctor.rules.similar_name import are_similar
from my_robot_basics.graph import graphs
from my_robot_basics.graph.snapshot import GraphSnapshot
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.ros2 import discovery


class _Graph(NamedTuple):
    snapshot: GraphSnapshot
    topic_ends: tuple[Endpoint, ...]
    service_ends: tuple[Endpoint, ...]


def diagnose(
    name: str,
    *,
    domain_id: int,
    other_domains: bool = False,
    seconds: float = looking.LISTEN_SEC,
    raised: service_looking.Raised = lambda _: {},
) -> tuple[Diagnosis, ...]:
    """Look at what has this full name in a ROS domain: a topic, a service, or one of each.

    Listens to a topic until enough has arrived, and watches a service until all is clear, each
    for `seconds` at most. With `other_domains` the other domains in use on this machine are looked
    at too, where an end is missing. `raised` tells, by their nodes, what the callbacks of a
    service have raised.
    """
    topic = service = None
    with Watcher(domain_id=domain_id) as watcher:
        graph, is_topic, is_service = _find(watcher, name, domain_id)
        if is_service:
            service = service_looking.look(
                watcher, name, domain_id=domain_id, raised=raised, look_sec=seconds
            )
        if is_topic or not is_service:
            topic = looking.look(
                watcher, graph.snapshot, name, domain_id=domain_id, listen_sec=seconds
            )
    found: list[Diagnosis] = []
    if topic is not None:
        if other_domains and not all(topic.ends(kind) for kind in topic.NEEDED):
            ends = _elsewhere(name, domain_id, looking.endpoints_of)
            topic = dataclasses.replace(topic, elsewhere=ends)
        found.append(rules.judge(topic))
    if service is not None:
        if other_domains and not service.servers:
            ends = _elsewhere(name, domain_id, service_looking.endpoints_of)
            service = dataclasses.replace(service, elsewhere=ends)
        found.append(service_rules.judge(service))
    return tuple(found)


def _find(watcher: Watcher, name: str, domain_id: int) -> tuple[_Graph, bool, bool]:
    """The graph, and whether it has a topic, and a service, of that name."""
    graph = _take(watcher)
    if not any(end.name == name and end.kind != 'client' for end in sum(graph[1:], ())):
        # before anybody is called missing
        discovery.settle(watcher.node, watcher.spin_for, domain_id=domain_id)
        graph = _take(watcher)
    is_topic = any(end.name == name for end in graph.topic_ends)
    is_service = any(end.name == name for end in graph.service_ends)
    if not (is_topic or is_service):
        is_service = _is_near(name, graph.service_ends) and not _is_near(name, graph.topic_ends)
    return graph, is_topic, is_service


def _take(watcher: Watcher) -> _Graph:
    snapshot = graphs.take(watcher)
    return _Graph(
        snapshot,
        tuple(looking.endpoints_of(watcher.node)),
        service_looking.endpoints_of(watcher.node),
    )


def _is_near(name: str, ends: Iterable[Endpoint]) -> bool:
    return any(are_similar(name, end.name) for end in ends)


def _elsewhere(
    name: str, domain_id: int, ends_of: Callable[[Node], Iterable[Endpoint]]
) -> dict[int, tuple[Endpoint, ...]]:
    """The ends of that name in the other domains that are in use on this machine."""
    found = {}
    for other in looking.other_domains(domain_id):
        with Watcher(domain_id=other) as watcher:
            graphs.take(watcher)
            found[other] = tuple(end for end in ends_of(watcher.node) if end.name == name)
    return found
