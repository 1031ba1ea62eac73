"""Collects the evidence on a service: the graph, nodes' answers, and what their callbacks do.

The service is never called: a call may have side effects, such as moving a robot.
"""

from collections.abc import Callable, Mapping

from rclpy.node import Node

from my_robot_basics.doctor import inside, remaps
from my_robot_basics.doctor.asking import Questions
from my_robot_basics.doctor.evidence import Endpoint, Kind, NodeState
from my_robot_basics.doctor.inside import SURE_SEC, Inside
from my_robot_basics.doctor.looking import missing_participants
from my_robot_basics.doctor.served_evidence import ServiceEvidence, Unanswered
from my_robot_basics.graph import services
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session.pressure import Stopwatch

SILENT_SEC = 3.0
"""A node that is not known to be busy counts as silent if it has not answered a parameter request
for this long; only time with a free processor counts."""
SILENT_MOST_SEC = 15.0
"""The same in wall time, for a busy machine."""
EVERY_SEC = 0.05
BUSY_TIMES = 2.5
"""How many times as long the look may take if processes have to wait for a processor."""

Raised = Callable[[str], Mapping[str, str]]


def endpoints_of(node: Node) -> tuple[Endpoint, ...]:
    """Return all service clients and servers, except ROS's own and hidden nodes'."""
    ends = services.take_graph(node)
    kinds: dict[Kind, dict] = {'client': ends.clients, 'server': ends.servers}
    return tuple(
        Endpoint(kind=kind, node_name=node_name, name=name, type_name=type_name)
        for kind, found in kinds.items()
        for name, nodes in sorted(found.items())
        if '/_' not in name  # else it belongs to an action, or is hidden
        for node_name, types in sorted(nodes.items())
        for type_name in types
    )


def look(
    watcher: Watcher, name: str, *, domain_id: int, raised: Raised, look_sec: float
) -> ServiceEvidence:
    """Return the evidence on a service, from a watcher that has taken the graph.

    `raised` returns the last exception of the service's callback by node. The look ends as soon
    as the evidence is clear, at most after `look_sec` of time with a free processor.
    """
    endpoints = endpoints_of(watcher.node)
    names = sorted({end.node_name for end in endpoints if end.name == name})
    questions, view, watch = Questions(watcher, names), Inside(name), Stopwatch()
    while watch.free_sec() < look_sec and watch.wall_sec() < BUSY_TIMES * look_sec:
        view.look()
        if _is_enough(name, questions, view, names, watch):
            break
        watcher.spin_for(EVERY_SEC)
    unspun = view.unspun() if watch.wall_sec() >= SURE_SEC else frozenset()
    answers = questions.answers(timeout_sec=0.0)
    if not _is_long(watch):
        # too early to call any other node silent
        unknown = questions.unanswered() - unspun
        answers = {node_name: answers[node_name] for node_name in answers.keys() - unknown}
    return ServiceEvidence(
        name=name,
        endpoints=endpoints,
        nodes=dict.fromkeys(services.take_graph(watcher.node).node_names, NodeState(answers=None))
        | answers,
        remaps=remaps.remaps_in_domain(domain_id),
        domain_id=domain_id,
        missing_participants=missing_participants(watcher.node, domain_id),
        callbacks=view.lasting(),
        looked_sec=watch.wall_sec(),
        raised=raised(name),
        visible=inside.observable_nodes(),
        unspun=unspun,
        taken=inside.nodes_taken_from_executors(),
        unanswered=tuple(
            Unanswered(node_name=node_name, seconds=seconds)
            for node_name, seconds in view.unanswered(at_least_sec=SURE_SEC).items()
        ),
    )


def _is_enough(
    name: str, questions: Questions, view: Inside, names: list[str], watch: Stopwatch
) -> bool:
    """Whether a longer look would find nothing new."""
    going_on = [
        each
        for each in view.callbacks(at_least_sec=EVERY_SEC / 2)
        if {*each.holds} & {*names}
        or (each.node_name in names and (each.keeps or each.service_name == name))
    ]
    if going_on:
        return any(each.is_sure() and each.seconds >= SURE_SEC for each in going_on)
    lost = view.unanswered(at_least_sec=0.0)
    if any(seconds < SURE_SEC for seconds in lost.values()):
        return False
    silent = questions.unanswered()
    if watch.wall_sec() >= SURE_SEC:
        silent -= view.unspun()
    return not silent or _is_long(watch)


def _is_long(watch: Stopwatch) -> bool:
    """Whether a node that is spun would have answered by now."""
    return watch.free_sec() >= SILENT_SEC or watch.wall_sec() >= SILENT_MOST_SEC
