"""Collects the evidence on an action: the graph, and what its server publishes about its goals.

It never sends a goal or a cancel request.
"""

import contextlib
from collections.abc import Iterable
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_action_status_default

from my_robot_basics.doctor import remaps
from my_robot_basics.doctor.evidence import Endpoint, Kind, NodeState
from my_robot_basics.doctor.inside import Inside
from my_robot_basics.doctor.looking import missing_participants
from my_robot_basics.doctor.served_evidence import ActionEvidence, StandingGoal
from my_robot_basics.graph import actions
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.ros2 import interfaces
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.session.pressure import Stopwatch

STATUS_SEC = 0.5
"""How long the transient-local message with the states of all goals may take to arrive."""
STANDS_SEC = 3.0
"""A goal without progress for this long is reported; only time with a free processor counts."""
EVERY_SEC = 0.05
BUSY_TIMES = 2.5
"""How many times as long the look may take if processes have to wait for a processor."""
LOG_DEPTH = 1_000
MOST_CHARACTERS = 100
_ACTIVE = {
    GoalStatus.STATUS_ACCEPTED: 'accepted',
    GoalStatus.STATUS_EXECUTING: 'executing',
    GoalStatus.STATUS_CANCELING: 'canceling',
}
_NOT_SET = 'Goal state not set'
_RAISED = 'Error raised in execute callback: '


def endpoints_of(node: Node) -> tuple[Endpoint, ...]:
    """Return all action clients and servers, except those of hidden nodes."""
    ends = actions.take_graph(node)
    kinds: dict[Kind, dict] = {'client': ends.clients, 'server': ends.servers}
    return tuple(
        Endpoint(kind=kind, node_name=node_name, name=name, type_name=type_name)
        for kind, found in kinds.items()
        for name, nodes in sorted(found.items())
        for node_name, types in sorted(nodes.items())
        for type_name in types
    )


class _ActionRecorder:
    """What the server of an action publishes about its goals, and what nodes log."""

    def __init__(self, node: Node, name: str, type_name: str) -> None:
        self.states: dict[bytes, str] = {}
        """The state of each unfinished goal, by goal ID."""
        self.moving: set[bytes] = set()
        """Goals whose state has changed, or that got feedback, since they were first seen."""
        self.lines: list[tuple[str, str]] = []
        """Pairs of a logger's name and a line that it has logged."""
        topics, status_qos = f'{name}/_action', qos_profile_action_status_default
        node.create_subscription(GoalStatusArray, f'{topics}/status', self._states, status_qos)
        latched = QoSProfile(depth=LOG_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(Log, '/rosout', self._line, latched)
        with contextlib.suppress(CommandError):  # a type that is not installed here
            feedback = interfaces.action_class_for(type_name).Impl.FeedbackMessage
            node.create_subscription(feedback, f'{topics}/feedback', self._feedback, 10)

    def _states(self, message: GoalStatusArray) -> None:
        now = {
            bytes(each.goal_info.goal_id.uuid): _ACTIVE[each.status]
            for each in message.status_list
            if each.status in _ACTIVE
        }
        known = self.states
        self.moving |= {goal for goal in now if goal in known and now[goal] != known[goal]}
        self.states = now

    def _feedback(self, message: Any) -> None:
        self.moving.add(bytes(message.goal_id.uuid))

    def _line(self, message: Log) -> None:
        self.lines.append((message.name, message.msg))

    def logged_by(self, node_names: Iterable[str]) -> list[tuple[str, str]]:
        """Return pairs of a node's full name and a line that it has logged, for these nodes."""
        loggers = {name: name.strip('/').replace('/', '.') for name in node_names}
        return [
            (name, line)
            for logger, line in self.lines
            for name, own in loggers.items()
            if f'{logger}.'.startswith(f'{own}.')
        ]


def look(watcher: Watcher, name: str, *, domain_id: int, look_sec: float) -> ActionEvidence:
    """Return the evidence on an action, from a watcher that has taken the graph.

    The look ends when every goal has made progress or there is none, at most after `look_sec`.
    """
    endpoints = endpoints_of(watcher.node)
    servers = [end for end in endpoints if (end.kind, end.name) == ('server', name)]
    told = _ActionRecorder(watcher.node, name, servers[0].type_name if servers else '')
    watch, view = Stopwatch(), Inside()
    while watch.free_sec() < STATUS_SEC or (
        told.states.keys() - told.moving and not _is_long(watch, look_sec)
    ):
        view.look()
        watcher.spin_for(EVERY_SEC)
        if watch.wall_sec() >= BUSY_TIMES * look_sec:
            break
    lines = told.logged_by({end.node_name for end in servers})
    standing = told.states.keys() - told.moving
    return ActionEvidence(
        name=name,
        endpoints=endpoints,
        nodes=dict.fromkeys(actions.take_graph(watcher.node).node_names, NodeState(answers=None)),
        remaps=remaps.remaps_in_domain(domain_id),
        domain_id=domain_id,
        missing_participants=missing_participants(watcher.node, domain_id),
        callbacks=view.lasting(),
        goals=tuple(
            StandingGoal(state=told.states[goal], seconds=watch.wall_sec())
            for goal in sorted(standing)
            if _is_long(watch, look_sec)
        ),
        proceeding=len(told.states.keys() & told.moving),
        unset=frozenset(node_name for node_name, line in lines if _NOT_SET in line),
        raised=tuple(
            (node_name, ' '.join(line.removeprefix(_RAISED).split())[:MOST_CHARACTERS])
            for node_name, line in lines
            if line.startswith(_RAISED)
        )[-1:],
    )


def _is_long(watch: Stopwatch, look_sec: float) -> bool:
    """Whether a goal that makes progress would have shown it by now."""
    long_sec = min(STANDS_SEC, look_sec)
    return watch.free_sec() >= long_sec or watch.wall_sec() >= BUSY_TIMES * long_sec
