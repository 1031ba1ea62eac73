"""A node that a command line of the notebook starts: its name, its topic, its parameters."""

import math
import random
from dataclasses import dataclass
from typing import Any

from sensor_msgs.msg import JointState

from my_robot_basics.checks.nodes import remap_hints
from my_robot_basics.checks.nodes.parameters import NodeParameters
from my_robot_basics.checks.nodes.started_node import StartedNode, started_node
from my_robot_basics.checks.topics.topics import topic
from my_robot_basics.exchange import student
from my_robot_basics.feedback.errors import expect, fail, shorten
from my_robot_basics.feedback.hidden import student_text
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.ros2 import command_line
from my_robot_basics.ros2.command_line import OPTIONS_OF_FILES, CommandLine

NODE_SEC = 4.0
"""How long a command's node may take to appear, in seconds of free time. It is short because the
cell that starts the node has waited for it before."""
MOST_POSES = 3_600
"""An hour of poses at 1 Hz: how far the node has come when the check receives one is unknown."""
_OF_ALL = '/rosout', '/parameter_events'
"""The topics on which every node of rclpy publishes."""
_PACKAGE, _EXECUTABLE = 'my_robot_basics', 'kinematics_publisher'


def node_command(name: str, node_name: str) -> 'NodeCommand':
    """The node `node_name` (a full name), which the notebook's variable `name` should start.

    The variable holds one command line for `kinematics_publisher`, as `run_commands` takes it.
    Raises CheckFailed if it does not. Call this for all variables before other checks, because
    `run_commands` starts no node if one command line is wrong.
    """
    text = student.value(name, type=str)
    try:
        line = command_line.parse(text, package=_PACKAGE, executable=_EXECUTABLE)
    except command_line.BadCommandLine as error:
        fail(
            expected=f'`{name}` to be one command line that starts {_EXECUTABLE}',
            seen=student_text(shorten(error.seen)),
            hint=error.hint,
            cause=f'`{name}` is not a command line',
        )
    return NodeCommand(line, node_name)


@dataclass(frozen=True)
class NodeCommand:
    """The assertions of a check about the node that a command line starts."""

    line: CommandLine
    node_name: str
    """The full name, such as '/left/arm'."""

    def expect_publishes(self, topic_name: str, *, instead_of: str) -> None:
        """Exactly one node has this name, and it is the only publisher on that topic.

        `instead_of` is the topic that the program uses without a remap rule. Raises CheckFailed.
        """
        self._expect_node()
        with Watcher(shared=True) as watcher:
            # on a busy machine, a node may be discovered long before its publishers
            watcher.spin_until_free(lambda: self._publishes(watcher), free_sec=NODE_SEC)
            graphs.wait_for_publisher(watcher, topic_name, timeout_sec=1.0)
            snapshot = graphs.take_snapshot(watcher)
        publishers = snapshot.publishers(topic_name)
        names = [
            name for name, nodes in snapshot.publisher_names.items() if self.node_name in nodes
        ]
        own = [name for name in names if name.endswith('joint_states')]
        expect(
            self.node_name in publishers,
            expected=f'{self.node_name} to publish on {topic_name}',
            seen=f'it publishes on {student_text(shorten(", ".join(own)))}'
            if own
            else 'it does not',
            hint=remap_hints.for_a_topic(self.line, self.node_name, instead_of),
            cause=f'{self.node_name} does not publish on {topic_name}',
        )
        expect(
            len(publishers) == 1,
            expected=f'one publisher on {topic_name}',
            seen=student_text(shorten(', '.join(publishers))),
            hint='give each node a topic of its own',
            cause=f'several nodes publish on {topic_name}',
        )
        self._expect_of_the_command(topic_name, instead_of=instead_of)

    def _publishes(self, watcher: Watcher) -> bool:
        names = graphs.take_snapshot(watcher).publisher_names
        return any(self.node_name in nodes for name, nodes in names.items() if name not in _OF_ALL)

    def _expect_of_the_command(self, topic_name: str, *, instead_of: str) -> None:
        """The command line itself gives that node and topic; another node cannot stand in."""
        started = self._started(topic_name=instead_of)
        expect(
            started is not None and started.name == self.node_name,
            expected=f'{self.node_name} to be the node of the command line',
            seen=f'the node {student_text(started.name)}' if started else 'rcl refuses a rule',
            hint=remap_hints.for_a_name(self.line, self.node_name),
            cause=f'the command line does not start {self.node_name}',
        )
        seen = started.topic_name if started else ''
        expect(
            seen == topic_name,
            expected=f'the command line to make {topic_name} of {instead_of}',
            seen=student_text(seen),
            hint=remap_hints.for_a_topic(self.line, self.node_name, instead_of),
            cause='the command line brings another topic',
        )

    def _started(
        self, *, topic_name: str = '', parameter_name: str = 'seed'
    ) -> StartedNode | None:
        return started_node(
            self.line,
            node_name=_EXECUTABLE,
            topic_name=topic_name,
            parameter_name=parameter_name,
        )

    def _expect_node(self) -> None:
        with Watcher(shared=True) as watcher:
            watcher.spin_until_free(
                lambda: self.node_name in graphs.node_names(watcher.node), free_sec=NODE_SEC
            )
            names = graphs.take_snapshot(watcher).nodes()
            count = graphs.node_names(watcher.node).count(self.node_name)
        expect(
            count > 0,
            expected=f'the node {self.node_name}',
            seen=student_text(shorten(', '.join(names))) or 'no node',
            hint=remap_hints.for_a_name(self.line, self.node_name),
            cause=f'there is no node {self.node_name}',
        )
        expect(
            count == 1,
            expected=f'one node {self.node_name}',
            seen=f'{count} of that name',
            hint='give each node a name of its own: run the cell with run_commands once more',
            cause=f'there are several nodes {self.node_name}',
        )

    def expect_parameter(self, name: str, value: Any) -> None:
        """The node's parameter `name` has that value. Raises CheckFailed."""
        seen = NodeParameters(self.node_name).get(name)
        expect(
            seen == value,
            expected=f'{name} = {value} of {self.node_name}',
            seen=student_text(shorten(repr(seen))),
            hint=_in_the_file(name, self.node_name)
            if self.line.options(*OPTIONS_OF_FILES)
            else remap_hints.for_a_parameter(self.line, name, value),
            cause=f'{name} has another value',
        )
        started = self._started(parameter_name=name)
        expect(
            started is not None and (started.has_file or started.parameter == value),
            expected=f'{name} = {value} in the command line of {self.node_name}',
            seen=student_text(shorten(repr(started.parameter)))
            if started
            else 'rcl refuses a rule',
            hint=remap_hints.for_a_parameter(self.line, name, value),
            cause=f'the command line gives {name} another value',
        )

    def expect_poses(self, topic_name: str, *, seed: int) -> None:
        """A pose on that topic is one that `kinematics_publisher` publishes with that seed.

        Raises CheckFailed.
        """
        numbers = random.Random(seed)
        poses = {
            (math.radians(numbers.uniform(-90.0, 90.0)), math.radians(numbers.uniform(-120, 120)))
            for _ in range(MOST_POSES)
        }
        topic(topic_name).wait_for(
            lambda message: tuple(message.position) in poses,
            timeout_sec=5.0,
            expected=f'a pose of the seed {seed} on {topic_name}',
            seen=lambda message: f'the pose {[round(angle, 3) for angle in message.position]}',
            hint='the node takes its seed when it starts: give it in the command line',
            type_=JointState,
        )


def _in_the_file(name: str, node_name: str) -> str:
    return (
        f'in the YAML file the node has its full name, {node_name}: and under it are '
        f'ros__parameters: and {name}'
    )
