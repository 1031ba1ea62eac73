"""A robot that the student has not seen before, for the exercise about nodes on a topic."""

from typing import Any

from geometry_msgs.msg import Point
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState, Temperature

from my_robot_basics.live.nodes import runner
from my_robot_basics.session.errors import tell

TOPIC = '/kinematics/joint_states'
PERIOD_SEC = 0.1
TEMPERATURE = '/kinematics/joint_temperature'
TOOL = '/kinematics/tool_point'


class UnknownRobot(Node):
    """Creates all nodes of the robot, publishes for them, and destroys them with itself."""

    def __init__(self) -> None:
        super().__init__('_unknown_robot', enable_rosout=False, start_parameter_services=False)
        self._parts: list[Node] = []
        self._publishers_and_messages: list[tuple[Publisher, Any]] = []
        # not a table that students can import: they have to ask the running system
        self._add('encoder_board', publishes=(TOPIC, TEMPERATURE))
        self._add('self_test', publishes=(TOPIC,), subscribes=(TOPIC,))
        self._add('motor_guard', subscribes=(TOPIC, TEMPERATURE))
        self._add('pose_logger', subscribes=(TOPIC,))
        self._add('tool_tracker', publishes=(TOOL,), subscribes=(TOPIC,))
        # nodes that only seem to be on the topic
        self._add('joint_viewer', subscribes=('/kinematics/joint_state',))
        self._add('gripper_driver', publishes=('/joint_states',), subscribes=(TOOL,))
        self._add('left_arm_board', publishes=('/left_arm/kinematics/joint_states',))
        self.create_timer(PERIOD_SEC, self._publish)

    @property
    def runs(self) -> bool:
        """Whether its nodes run."""
        return bool(self._parts) and self.context.ok()

    @property
    def size(self) -> int:
        """The number of its nodes."""
        return len(self._parts)

    def strangers(self) -> list[str]:
        """Return the names of other nodes on the robot's topic."""
        own = {part.get_name() for part in self._parts}
        infos = [
            *self.get_publishers_info_by_topic(TOPIC),
            *self.get_subscriptions_info_by_topic(TOPIC),
        ]
        names = {info.node_name for info in infos if not info.node_name.startswith('_')}
        return sorted(names - own)

    def destroy_node(self) -> None:
        """Destroy the parts, then this node."""
        while self._parts:
            self._parts.pop().destroy_node()
        super().destroy_node()

    def _add(
        self, name: str, *, publishes: tuple[str, ...] = (), subscribes: tuple[str, ...] = ()
    ) -> None:
        """Create a node with that name, which no other lesson uses."""
        # the node is not spun, so that parameter services would never answer
        node = Node(name, start_parameter_services=False)
        self._parts.append(node)
        for topic_name in publishes:
            message = _message(topic_name)
            publisher = node.create_publisher(type(message), topic_name, 10)
            self._publishers_and_messages.append((publisher, message))
        for topic_name in subscribes:
            type_ = type(_message(topic_name))
            node.create_subscription(type_, topic_name, lambda message: None, 10)

    def _publish(self) -> None:
        for publisher, message in self._publishers_and_messages:
            if hasattr(message, 'header'):
                message.header.stamp = self.get_clock().now().to_msg()
            publisher.publish(message)


_robot: UnknownRobot | None = None


def start_unknown_robot() -> None:
    """Start the robot's nodes, unless they run, and print which other nodes are on its topic."""
    global _robot
    if _robot is None or not _robot.runs:
        _robot = runner.run(UnknownRobot)
    if _robot is None:
        return
    tell(f'the unknown robot runs: {_robot.size} nodes')
    if strangers := _robot.strangers():
        tell(
            f'note: {", ".join(strangers)} is on {TOPIC} and is not part of it: '
            'stop it (Ctrl-C in its terminal), then look again'
        )


def _message(topic_name: str) -> JointState | Point | Temperature:
    """Return the message for a topic of the robot; in rad, metres or degrees Celsius."""
    if topic_name == TOOL:
        return Point(x=1.2, y=0.8)
    if topic_name == TEMPERATURE:
        return Temperature(temperature=41.0)
    return JointState(name=['joint1', 'joint2'], position=[0.3, -0.6])
