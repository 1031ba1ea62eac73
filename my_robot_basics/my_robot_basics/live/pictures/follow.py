"""A picture of the arm that moves with the joint states on a topic."""

import math
import threading
from collections.abc import Callable

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState

from my_robot_basics.drawing.arm import ArmPicture
from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.live.nodes import runner
from my_robot_basics.live.output import notebook
from my_robot_basics.live.output.troubles import where_and_what
from my_robot_basics.two_link_kinematics import L1, L2

JOINTS = ('joint1', 'joint2')
FIRST_MESSAGE_SEC = 1.2
"""How long to wait for a first pose if there is a publisher, so that a saved notebook shows it."""


def follow_arm(
    topic_name: str = '/kinematics/joint_states', *, l1: float = L1, l2: float = L2
) -> None:
    """Show the arm in the pose of the JointState messages on a topic, until `stop()`.

    The picture is updated in place, a few times a second, after the cell has returned. Messages
    without a valid pose are counted below the title. Link lengths are in metres.
    """
    view = ArmView(topic_name, l1=l1, l2=l2)
    node_name = '_follow' + ''.join(c if c.isalnum() else '_' for c in topic_name)
    node = runner.launch(
        ArmFollower,
        (node_name, topic_name, view.receive),
        {},
        key=node_name,
        make_panel=lambda: view,
    )
    if node is not None and node.count_publishers(topic_name):
        view.received.wait(FIRST_MESSAGE_SEC)
    view.publish()


class ArmFollower(Node):
    """Passes each joint state of a topic on."""

    def __init__(
        self, node_name: str, topic_name: str, receive: Callable[[JointState], None]
    ) -> None:
        """Subscribe with a QoS profile compatible with any publisher, for the newest message."""
        super().__init__(node_name, enable_rosout=False, start_parameter_services=False)
        qos_profile = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.create_subscription(JointState, topic_name, receive, qos_profile)


class ArmView:
    """A picture in place of a panel with log lines."""

    _make_picture = ArmPicture

    def __init__(self, topic_name: str, *, l1: float, l2: float) -> None:
        """Draw the axes of the picture."""
        self.received = threading.Event()
        self._topic_name = topic_name
        self._text = self._about(topic_name)
        self._picture = self._make_picture(l1=l1, l2=l2)
        self._pose: tuple[float, float] | None = None
        self._ignored = 0
        self._trouble = f'waiting for messages on {topic_name}'
        self._display = notebook.Display()
        self._drawing = threading.Lock()

    def _about(self, topic_name: str) -> str:
        """Return the beginning of the picture's alternative text."""
        return gettext_noop(f'two-link arm that follows {topic_name}')

    def receive(self, message: JointState) -> None:
        """Take the pose from a message, or show what is wrong with it."""
        trouble = what_is_wrong(message)
        if trouble:
            self._ignored += 1
            self._trouble = f'{self._ignored} ignored: {trouble}'
        else:
            position = dict(zip(message.name, message.position, strict=False))
            theta1_deg, theta2_deg = (math.degrees(position[joint]) for joint in JOINTS)
            self._pose = theta1_deg, theta2_deg
            self._trouble = f'{self._ignored} ignored' if self._ignored else ''
        self.received.set()
        self._display.update_soon(self._bundle)

    def publish(self) -> None:
        """Show the picture for the first time."""
        self._display.show(self._bundle())

    def _bundle(self) -> dict:
        with self._drawing:  # the thread that stops the node draws the last picture
            title = '\n'.join(filter(None, [self._topic_name, self._trouble]))
            if self._pose is None:
                self._picture.title(title)
            else:
                self._picture.move(*self._pose, title=title)
            return {'image/png': self._picture.png(), 'text/plain': self._text}

    def listen(self, name: str) -> None:
        """Do nothing: a picture has no log lines."""

    def adopt_thread(self) -> None:
        """Do nothing: the node prints nothing."""

    def show(self, state: str) -> None:
        """Do nothing: `follow_arm` publishes the picture once there is a pose."""

    def error(self, error: BaseException) -> None:
        """Show an exception of the course's code above the picture."""
        self._trouble = where_and_what(error)[1]
        self._display.update_soon(self._bundle)

    def close(self, reason: str) -> None:
        """Keep the last picture, with the reason above it."""
        self._trouble = reason
        self._display.update(self._bundle())


def what_is_wrong(message: JointState) -> str:
    """Return why a message has no valid pose, or '' if it has one."""
    missing = [joint for joint in JOINTS if joint not in message.name]
    if missing:
        return f'no {" and no ".join(missing)} among the names {list(message.name)}'
    if len(message.position) < len(message.name):
        return f'{len(message.name)} names, but {len(message.position)} positions'
    position = dict(zip(message.name, message.position, strict=False))
    for joint in JOINTS:
        if not math.isfinite(position[joint]):
            return f'the position of {joint} is {position[joint]}'
    return ''
