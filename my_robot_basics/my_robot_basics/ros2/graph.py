"""The ROS graph as the command sees it: one layer over rclpy's graph API.

rclpy is imported only when a graph is entered.
"""

import argparse
import contextlib
import math
import os
import select
import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

from my_robot_basics.ros2 import discovery, environment, lookup, stopping
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.node_name import NodeName

if TYPE_CHECKING:
    from rclpy.node import Node

HIDDEN_PREFIX = '_'
WAIT_SEC = 0.05
"""The longest time between two checks for signals and a closed pipe."""


class Graph:
    """The command's node on the graph, for the duration of a with statement.

    Its name, `_ros2cli_<pid>`, hides it from lists of nodes, as in ros2cli.
    """

    node: 'Node'

    def __init__(self, args: argparse.Namespace, *, node_name: str | None = None) -> None:
        self._node_name = node_name or f'_ros2cli_{os.getpid()}'
        self._spin_time_sec = getattr(args, 'spin_time', None)
        self._use_sim_time = getattr(args, 'use_sim_time', False)
        self._pipe = select.poll()
        with contextlib.suppress(ValueError, OSError):  # in a test, stdout may not be a file
            self._pipe.register(sys.stdout.fileno(), 0)

    def __enter__(self) -> 'Graph':
        """Create the context, the node and its executor."""
        # saves a fifth of the start-up time: messages import a package that also has the unneeded
        # generator of message modules, and may do without that part
        modules = cast('dict[str, object]', sys.modules)
        modules.setdefault('rosidl_generator_py.generate_py_impl', None)
        import rclpy
        from rclpy.exceptions import InvalidNodeNameException
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.node import Node
        from rclpy.parameter import Parameter
        from rclpy.signals import SignalHandlerOptions
        from rclpy.validate_node_name import validate_node_name

        try:
            validate_node_name(self._node_name)
        except InvalidNodeNameException as error:
            raise CommandError(str(error)) from None
        environment.print_joined_lesson()
        stopping.only_record_signals()
        rclpy.init(
            args=[],
            domain_id=environment.domain_id(),
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self.node = Node(
            self._node_name,
            start_parameter_services=False,
            parameter_overrides=[
                Parameter('use_sim_time', value=self._use_sim_time),
                # the service is not needed, and its imports take 60 ms
                Parameter('start_type_description_service', value=False),
            ],
        )
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        return self

    def __exit__(self, *_: object) -> None:
        """Destroy the node and shut rclpy down."""
        import rclpy

        self._executor.shutdown()
        self.node.destroy_node()
        rclpy.try_shutdown()

    def check(self) -> None:
        """Raise Stopped after a signal, and BrokenPipeError once the reader of stdout is gone."""
        stopping.check()
        if any(event & (select.POLLERR | select.POLLHUP) for _, event in self._pipe.poll(0)):
            raise BrokenPipeError

    def sleep(self, seconds: float) -> None:
        """Wait without spinning; a signal or a closed pipe ends it by an exception."""
        self.wait_until(lambda: False, timeout_sec=seconds)

    def wait_until(self, done: Callable[[], bool], *, timeout_sec: float = math.inf) -> bool:
        """Wait without spinning until done() is true; return whether it is."""
        deadline = time.monotonic() + timeout_sec
        while not (is_done := done()) and time.monotonic() < deadline:
            self.check()
            time.sleep(min(discovery.POLL_SEC, max(0.0, deadline - time.monotonic())))
        return is_done

    def spin_until(self, done: Callable[[], bool], *, timeout_sec: float = math.inf) -> bool:
        """Run callbacks until done() is true; return whether it is."""
        deadline = time.monotonic() + timeout_sec
        while not (is_done := done()) and time.monotonic() < deadline:
            self.check()
            left_sec = max(0.0, deadline - time.monotonic())
            self._executor.spin_once(timeout_sec=min(WAIT_SEC, left_sec))
        return is_done

    def spin(self) -> None:
        """Run callbacks until a signal comes or the reader of stdout is gone."""
        self.spin_until(lambda: False)

    def settle(self) -> None:
        """Wait until the graph has settled, or for the time of `--spin-time`."""
        if self._spin_time_sec is None:
            discovery.settle(self.node, self.sleep)
        else:
            self.sleep(self._spin_time_sec)

    def publishers_of(self, topic_name: str) -> list[Any]:
        """Return each publisher's TopicEndpointInfo; raises CommandError for an invalid name."""
        return self.node.get_publishers_info_by_topic(lookup.full_name(self.node, topic_name))

    def subscribe(
        self,
        message_class: Any,
        topic_name: str,
        callback: Callable[..., None],
        qos_profile: Any,
        **options: Any,
    ) -> None:
        """Create a subscription; raises CommandError for an invalid name."""
        self.node.create_subscription(
            message_class,
            lookup.full_name(self.node, topic_name),
            callback,
            qos_profile,
            **options,
        )

    def advertise(self, message_class: Any, topic_name: str, qos_profile: Any) -> Any:
        """Create a publisher; raises CommandError for an invalid name."""
        return self.node.create_publisher(
            message_class, lookup.full_name(self.node, topic_name), qos_profile
        )

    def topics(self, *, include_hidden: bool = False) -> list[tuple[str, list[str]]]:
        """Return topic names and their types, sorted by name."""
        return lookup.visible(self.node.get_topic_names_and_types(), include_hidden)

    def services(self, *, include_hidden: bool = False) -> list[tuple[str, list[str]]]:
        """Return service names and their types, sorted by name."""
        return lookup.visible(self.node.get_service_names_and_types(), include_hidden)

    def actions(self) -> list[tuple[str, list[str]]]:
        """Return action names and their types, sorted by name; all of them, as in ros2cli."""
        from rclpy.action import get_action_names_and_types

        return sorted(get_action_names_and_types(self.node))

    def nodes(self, *, include_hidden: bool = False) -> list[NodeName]:
        """Return the nodes; a name that two nodes have is in the list twice."""
        names = (NodeName(*pair) for pair in self.node.get_node_names_and_namespaces())
        return [
            node for node in names if include_hidden or not node.name.startswith(HIDDEN_PREFIX)
        ]

    def wait_for_node(
        self, full_name: str, *, include_hidden: bool = False, timeout_sec: float = 1.0
    ) -> bool:
        """Wait until a node is on the graph; return whether it is."""

        def is_there() -> bool:
            nodes = self.nodes(include_hidden=include_hidden)
            return any(node.full_name == full_name for node in nodes)

        return self.wait_until(is_there, timeout_sec=timeout_sec)

    def message_class(self, topic_name: str, *, wait: bool = False) -> Any:
        """Return a topic's message class, or None, after a warning, while it does not exist.

        With `wait`, it prints the warning and waits for the topic. Raises CommandError for an
        invalid topic name, and for a topic with two types.
        """
        full_name = lookup.full_name(self.node, topic_name)
        if (found := lookup.message_class(self.node, topic_name)) is None:
            print(f'WARNING: topic [{topic_name}] does not appear to be published yet')
            if wait:
                self.wait_until(lambda: lookup.types(self.node, full_name) != [])
                found = lookup.message_class(self.node, topic_name)
        return found
