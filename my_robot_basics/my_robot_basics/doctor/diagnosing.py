"""Collects and judges the evidence on the topic, service or action with a given name."""

import dataclasses
from collections.abc import Callable, Iterable
from typing import NamedTuple

from rclpy.node import Node

from my_robot_basics.doctor import (
    action_looking,
    action_rules,
    looking,
    rules,
    service_looking,
    service_rules,
)
from my_robot_basics.doctor.evidence import Diagnosis, Endpoint
from my_robot_basics.doctor.rules.names import are_similar
from my_robot_basics.graph import graphs
from my_robot_basics.graph.snapshot import GraphSnapshot
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.ros2 import discovery


class _Graph(NamedTuple):
    snapshot: GraphSnapshot
    topic_ends: tuple[Endpoint, ...]
    service_ends: tuple[Endpoint, ...]
    action_ends: tuple[Endpoint, ...]

    def has(self, ends: tuple[Endpoint, ...], name: str) -> bool:
        """Whether one of `ends` has that name, or if none at all has it, only `ends` are near."""
        every = self.topic_ends, self.service_ends, self.action_ends
        if any(end.name == name for found in every for end in found):
            return any(end.name == name for end in ends)
        return _is_near(name, ends) and not any(_is_near(name, o) for o in every if o is not ends)


def diagnose(
    name: str,
    *,
    domain_id: int,
    other_domains: bool = False,
    seconds: float = looking.LISTEN_SEC,
    raised: service_looking.Raised = lambda _: {},
) -> tuple[Diagnosis, ...]:
    """Diagnose what has this full name in a ROS domain: a topic, a service, an action, or several.

    It receives messages of a topic until they are enough, and observes a service until the
    evidence is clear, each for at most `seconds`. If an end is missing, `other_domains` makes it
    search the other domains in use on this machine. `raised` returns, for a service, the last
    exception of its callback by node.
    """
    topic = service = action = None
    with Watcher(domain_id=domain_id) as watcher:
        graph = _find(watcher, name, domain_id)
        is_service, is_action = (
            graph.has(ends, name) for ends in (graph.service_ends, graph.action_ends)
        )
        if is_action:
            action = action_looking.look(watcher, name, domain_id=domain_id, look_sec=seconds)
        if is_service:
            service = service_looking.look(
                watcher, name, domain_id=domain_id, raised=raised, look_sec=seconds
            )
        if not (is_service or is_action) or any(e.name == name for e in graph.topic_ends):
            topic = looking.look(
                watcher, graph.snapshot, name, domain_id=domain_id, listen_sec=seconds
            )
    found: list[Diagnosis] = []
    if topic is not None:
        if other_domains and not all(topic.ends(kind) for kind in topic.NEEDED):
            ends = _ends_in_other_domains(name, domain_id, looking.endpoints_of)
            topic = dataclasses.replace(topic, elsewhere=ends)
        found.append(rules.judge(topic))
    if service is not None:
        if other_domains and not service.servers:
            ends = _ends_in_other_domains(name, domain_id, service_looking.endpoints_of)
            service = dataclasses.replace(service, elsewhere=ends)
        found.append(service_rules.judge(service))
    if action is not None:
        if other_domains and not action.servers:
            ends = _ends_in_other_domains(name, domain_id, action_looking.endpoints_of)
            action = dataclasses.replace(action, elsewhere=ends)
        found.append(action_rules.judge(action))
    return tuple(found)


def _find(watcher: Watcher, name: str, domain_id: int) -> _Graph:
    """Return the graph; if nothing but clients has that name, wait until discovery is complete."""
    graph = _take(watcher)
    if not any(end.name == name and end.kind != 'client' for end in sum(graph[1:], ())):
        # wait before an end is reported as missing
        discovery.settle(watcher.node, watcher.spin_for, domain_id=domain_id)
        graph = _take(watcher)
    return graph


def _take(watcher: Watcher) -> _Graph:
    snapshot = graphs.take_snapshot(watcher)
    return _Graph(
        snapshot,
        tuple(looking.endpoints_of(watcher.node)),
        service_looking.endpoints_of(watcher.node),
        action_looking.endpoints_of(watcher.node),
    )


def _is_near(name: str, ends: Iterable[Endpoint]) -> bool:
    return any(are_similar(name, end.name) for end in ends)


def _ends_in_other_domains(
    name: str, domain_id: int, ends_of: Callable[[Node], Iterable[Endpoint]]
) -> dict[int, tuple[Endpoint, ...]]:
    """Return the ends with that name in the other domains that are in use on this machine."""
    found = {}
    for other in looking.other_domains(domain_id):
        with Watcher(domain_id=other) as watcher:
            graphs.take_snapshot(watcher)
            found[other] = tuple(end for end in ends_of(watcher.node) if end.name == name)
    return found
