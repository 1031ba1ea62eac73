"""A robot that the student has not seen before: which of its nodes meet on a topic?"""

from dataclasses import dataclass

from geometry_msgs.msg import Point
from rclpy.node import Node
from sensor_msgs.msg import JointState, Temperature

from my_robot_basics.live import runner

TOPIC = '/kinematics/joint_states'
PERIOD_SEC = 0.1
WARMTH = '/kinematics/joint_temperature'
TOOL = '/kinematics/tool_point'


@dataclass(frozen=True)
class Part:
    """A node of the robot: its name, and the topics on which it publishes and subscribes."""

    name: str
    publishes: tuple[str, ...] = ()
    subscribes: tuple[str, ...] = ()


PARTS = (
    Part('encoder_board', publishes=(TOPIC, WARMTH)),
    Part('self_test', publishes=(TOPIC,), subscribes=(TOPIC,)),
    Part('motor_guard', subscribes=(TOPIC, WARMTH)),
    Part('pose_logger', subscribes=(TOPIC,)),
    Part('tool_tracker', publishes=(TOOL,), subscribes=(TOPIC,)),
    # and those that only seem to belong there
    Part('joint_viewer', subscribes=('/kinematics/joint_state',)),
    Part('gripper_driver', publishes=('/joint_states',), subscribes=(TOOL,)),
    Part('left_arm_board', publishes=('/left_arm/kinematics/joint_states',)),
)
"""All nodes of the robot. The names occur nowhere else in the lessons."""


class UnknownRobot(Node):
    """Brings all nodes of the robot along, lets them publish, and takes them with it."""

    def __init__(self) -> None:
        super().__init__('_unknown_robot', enable_rosout=False, start_parameter_services=False)
        # nobody spins the parts: a service of theirs would never answer
        self.parts = [Node(part.name, start_parameter_services=False) for part in PARTS]
        self._publishers_and_messages = []
        for node, part in zip(self.parts, PARTS, strict=True):
            for topic_name in part.publishes:
                message = _message(topic_name)
                publisher = node.create_publisher(type(message), topic_name, 10)
                self._publishers_and_messages.append((publisher, message))
            for topic_name in part.subscribes:
                type_ = type(_message(topic_name))
                node.create_subscription(type_, topic_name, lambda message: None, 10)
        self.create_timer(PERIOD_SEC, self._publish)

    @property
    def runs(self) -> bool:
        """Whether its nodes are there."""
        return bool(self.parts) and self.context.ok()

    def strangers(self) -> list[str]:
        """Names of nodes that are on the robot's topic and none of its own."""
        own = {part.name for part in PARTS}
        infos = [
            *self.get_publishers_info_by_topic(TOPIC),
            *self.get_subscriptions_info_by_topic(TOPIC),
        ]
        names = {info.node_name for info in infos if not info.node_name.startswith('_')}
        return sorted(names - own)

    def destroy_node(self) -> None:
        """Destroy the parts, then this node."""
        while self.parts:
            self.parts.pop().destroy_node()
        super().destroy_node()

    def _publish(self) -> None:
        for publisher, message in self._publishers_and_messages:
            if hasattr(message, 'header'):
                message.header.stamp = self.get_clock().now().to_msg()
            publisher.publish(message)


_robot: UnknownRobot | None = None


def start_unknown_robot() -> None:
    """Start the robot's nodes, unless they run already, and say who else is on its topic."""
    global _robot
    if _robot is None or not _robot.runs:
        _robot = runner.run(UnknownRobot)
    if _robot is None:
        return
    print(f'the unknown robot runs: {len(PARTS)} nodes')
    if strangers := _robot.strangers():
        print(
            f'note: {", ".join(strangers)} is on {TOPIC} and no part of it: '
            'stop it (Ctrl-C in its terminal), then look again'
        )


def _message(topic_name: str) -> JointState | Point | Temperature:
    """What goes over a topic of the robot; angles in rad, metres, degrees Celsius."""
    if topic_name == TOOL:
        return Point(x=1.2, y=0.8)
    if topic_name == WARMTH:
        return Temperature(temperature=41.0)
    return JointState(name=['joint1', 'joint2'], position=[0.3, -0.6])
