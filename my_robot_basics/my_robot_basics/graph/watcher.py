"""A check's own ROS node: it exists for one check, and no student code can reach it."""

import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Self

from rclpy.exceptions import NameValidationException
from rclpy.node import Node
from rclpy.parameter import Parameter

from my_robot_basics.feedback.errors import fail, shorten
from my_robot_basics.feedback.hidden import is_in_test_room, student_text
from my_robot_basics.graph.cell_context import context_of_cell, new_context
from my_robot_basics.graph.ignored_callback_group import IgnoredCallbackGroup
from my_robot_basics.graph.lean_executor import LeanExecutor
from my_robot_basics.graph.snapshot import GraphSnapshot
from my_robot_basics.graph.strange_names import has_strange_duration, strange_name
from my_robot_basics.session import classroom, interactions
from my_robot_basics.session.environment import set_meanwhile
from my_robot_basics.session.pressure import free_turns

TRANSPORTS = 'FASTDDS_BUILTIN_TRANSPORTS'
HIDDEN = '_'
"""Names of the course's own nodes start with this; checks and counts ignore these nodes."""
MOST_ENDPOINTS = 1_000
"""The limit of nodes, publishers, subscriptions and services in a domain. Thirty nodes have about
430; with many thousands, reading the graph would take too long."""
BY_RCLPY = 'make nodes, topics and services with rclpy alone, by names of ASCII letters'
_REFUSES = ValueError, NameValidationException
"""What rclpy raises if it should look up a name that rclpy itself could not have created."""
COUNT_EVERY_SEC = 0.5
"""How often the endpoints are counted for MOST_ENDPOINTS."""
LOOK_EVERY_SEC = 0.05


def _only_shared_memory() -> AbstractContextManager[None]:
    """Participants created inside have no sockets: each room has shared memory of its own."""
    return set_meanwhile(TRANSPORTS, 'SHM')


class Watcher:
    """A context manager around a node with a Context and an executor of its own.

    It spins only inside its `spin_…` methods, in the caller's thread: nothing runs in the
    background, and an interrupt ends the check immediately.
    """

    def __init__(
        self,
        *,
        domain_id: int | None = None,
        apart: bool = False,
        shared: bool = False,
        listens: bool = False,
    ) -> None:
        """`domain_id`: the ROS domain to join, instead of the lesson's.

        `apart`: in the grader, only discover participants that are in the test's room, too.
        `shared`: use the participant that the cell's checks share, if there is one.
        `listens`: the check leaves the nodes as it found them, so no interaction is counted.
        """
        self._domain_id, self._shared, self._listens = domain_id, shared, listens
        self._transports = _only_shared_memory if apart and is_in_test_room() else nullcontext
        self.late_sec = 0.0
        """The most by which a spin took longer than it should have."""
        self._next_count = 0.0
        self.earlier_look: tuple[float, GraphSnapshot | None] = 0.0, None
        """The graph at an earlier time of `time.monotonic()`, and that time first."""

    def __enter__(self) -> Self:
        """Join the domain."""
        if not self._listens:
            interactions.note()
        domain_id = classroom.enter() if self._domain_id is None else self._domain_id
        found = context_of_cell(domain_id) if self._shared else None
        self._is_own = found is None
        self.context = found or new_context(domain_id)
        self._executor = LeanExecutor(context=self.context)
        self._nodes: list[Node] = []
        with self._transports():  # the first node of a context creates the participant
            self.node = self.add_node('check')
        return self

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        """Leave the domain. Raises CheckFailed if names or QoS on the graph could not be read."""
        refused = strange_name(self.node) if isinstance(error, _REFUSES) else ''
        is_misdated = isinstance(error, OverflowError) and has_strange_duration(self.node)
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        if self._is_own:
            self.context.shutdown()
        if isinstance(error, UnicodeDecodeError):
            # rclpy decodes all names at once: one that is not UTF-8 hides all others
            fail(
                expected='names and types on the graph that are text',
                seen='bytes that are not UTF-8',
                hint=BY_RCLPY,
            )
        if is_misdated:
            fail(
                expected='QoS on the graph whose times are not negative',
                seen='one that rclpy cannot read',
                hint=BY_RCLPY,
            )
        if refused:
            fail(
                expected='names on the graph that ROS allows',
                seen=student_text(shorten(repr(refused))),
                hint=BY_RCLPY,
            )

    def add_node(self, name: str, *, namespace: str = '', cli_args: Sequence[str] = ()) -> Node:
        """Create one more hidden node, which is spun and destroyed together with the first."""
        node = Node(
            f'{HIDDEN}{name}',
            context=self.context,
            namespace=namespace,
            cli_args=list(cli_args),
            use_global_arguments=False,
            enable_rosout=False,
            # with these, student code could set use_sim_time here
            start_parameter_services=False,
            parameter_overrides=[Parameter('start_type_description_service', value=False)],
        )
        for event in node.waitables:  # QoS events of /parameter_events; each slows every wait down
            event.callback_group = IgnoredCallbackGroup()
        self._executor.add_node(node)
        self._nodes.append(node)
        return node

    def spin_until(self, done: Callable[[], bool], *, timeout_sec: float) -> bool:
        """Spin until `done()`, at most `timeout_sec` of monotonic time; return whether it is done.

        Raises CheckFailed if there are more than MOST_ENDPOINTS.
        """
        deadline = time.monotonic() + timeout_sec
        while True:
            self._expect_few_endpoints()
            if done():
                return True
            left = deadline - time.monotonic()
            if left <= 0.0:
                return False
            # `done` may look at the graph, whose changes do not wake the executor
            pause = min(left, 0.02)
            start = time.monotonic()
            self._executor.spin_once(timeout_sec=pause)
            self.late_sec = max(self.late_sec, time.monotonic() - start - pause)

    def spin_for(self, seconds: float) -> None:
        """Spin for `seconds` of monotonic time."""
        self.spin_until(lambda: False, timeout_sec=seconds)

    def spin_until_free(
        self, done: Callable[[], bool], *, free_sec: float, wall_sec: float | None = None
    ) -> bool:
        """Spin until `done()`, at most `free_sec` of free time; return whether it is done.

        Free time is time in which no process had to wait for a processor. `wall_sec`: the most
        wall time, if a node must not wait too long for the check, by its own timeouts.
        """
        # most waits end immediately: then Linux need not be asked how busy the machine is
        if self.spin_until(done, timeout_sec=min(LOOK_EVERY_SEC, free_sec)):
            return True
        turns = free_turns(free_sec, wall_sec)
        return any(self.spin_until(done, timeout_sec=LOOK_EVERY_SEC) for _ in turns)

    def _expect_few_endpoints(self) -> None:
        if time.monotonic() < self._next_count:
            return
        topic_names = [name for name, _ in self.node.get_topic_names_and_types()]
        count = len(self.node.get_service_names_and_types())
        # a participant may announce names of nodes that have no endpoint
        count += len(self.node.get_node_names_and_namespaces())
        for look_up in self.node.count_publishers, self.node.count_subscribers:
            count += sum(map(look_up, topic_names))
        if count > MOST_ENDPOINTS:
            fail(
                expected=f'at most {MOST_ENDPOINTS:,} nodes, topic endpoints and services',
                seen=f'{count:,}',
                hint='create each of them once, not in an endless loop or a callback',
            )
        self._next_count = time.monotonic() + COUNT_EVERY_SEC
