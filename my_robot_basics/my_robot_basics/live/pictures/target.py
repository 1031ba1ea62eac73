"""Sliders that publish a target point, and the arm that follows it over the topic."""

import threading

import ipywidgets
from geometry_msgs.msg import Point
from rclpy.node import Node
from rclpy.publisher import Publisher

from my_robot_basics.drawing.described import gettext_noop
from my_robot_basics.live.nodes import runner
from my_robot_basics.live.output import notebook
from my_robot_basics.live.pictures.follow import FIRST_MESSAGE_SEC, ArmView
from my_robot_basics.live.pictures.sliders import TARGET_WITHOUT_WIDGETS, show_widgets
from my_robot_basics.two_link_kinematics import L1, L2, inverse_kinematics

NODE_NAME = '_drag_target'


def drag_target(
    x: float = 1.2,
    y: float = 0.8,
    *,
    topic_name: str = '/target_point',
    l1: float = L1,
    l2: float = L2,
) -> None:
    """Show two sliders that publish a Point, and the arm that reaches for it, until `stop()`.

    The arm moves with each message on the topic, from any node: it is drawn as elbow_up, and
    dashed as elbow_down. Lengths and coordinates are in metres. Outside a notebook kernel there
    are no sliders: the point is published once.
    """
    view = TargetView(topic_name, x=x, y=y, l1=l1, l2=l2)
    node = runner.launch(
        TargetNode, (topic_name, view), {}, key=NODE_NAME, make_panel=lambda: view
    )
    if node is not None:
        view.publish_target()
        view.received.wait(FIRST_MESSAGE_SEC)
        view.publish()


class TargetNode(Node):
    """Publishes target points, and passes on all points of the topic."""

    def __init__(self, topic_name: str, view: 'TargetView') -> None:
        """Create both endpoints; a depth of 1 suffices, as only the newest target matters."""
        super().__init__(NODE_NAME, enable_rosout=False, start_parameter_services=False)
        view.publisher = self.create_publisher(Point, topic_name, 10)
        self.create_subscription(Point, topic_name, view.receive, 1)


class TargetView(ArmView):
    """The sliders, and the picture that takes a panel's place."""

    def __init__(self, topic_name: str, *, x: float, y: float, l1: float, l2: float) -> None:
        """Make the sliders and the axes of the picture."""
        super().__init__(topic_name, l1=l1, l2=l2)
        self._l1, self._l2 = l1, l2
        self._target: Point | None = None
        self._lock = threading.Lock()
        self.publisher: Publisher | None = None
        reach = 1.1 * (l1 + l2)
        self.x, self.y = (_slider(name, at, reach) for name, at in (('x', x), ('y', y)))

    def _about(self, topic_name: str) -> str:
        return gettext_noop(f'two-link arm that reaches for the target on {topic_name}')

    def publish(self) -> None:
        """Show sliders and picture for the first time."""
        if notebook.in_kernel():
            show_widgets(self.x, self.y, without=TARGET_WITHOUT_WIDGETS)
        super().publish()
        for slider in (self.x, self.y):
            slider.observe(self.publish_target, names='value')

    def publish_target(self, change: object = None) -> None:
        """Publish the sliders' values, in metres."""
        assert self.publisher is not None  # sliders are shown once the node has it
        self.publisher.publish(Point(x=self.x.value, y=self.y.value))

    def receive(self, message: Point) -> None:
        """Show the poses that reach a target, or why the arm can't reach it."""
        with self._lock:
            self._target = message
            try:
                solutions = inverse_kinematics(message.x, message.y, self._l1, self._l2)
            except ValueError as error:
                self._trouble = f'no pose: {str(error).partition(",")[0]}'
            else:
                self._trouble = 'solid: elbow_up, dashed: elbow_down'
                self._pose = solutions['elbow_up']
                self._picture.dashed(*solutions['elbow_down'])
        self.received.set()
        self._display.update(self._bundle())

    def close(self, reason: str) -> None:
        """Keep the last picture, and disable the sliders."""
        self.x.disabled = self.y.disabled = True
        super().close(reason)

    def _bundle(self) -> notebook.Bundle:
        with self._lock:
            if self._target is not None:
                self._picture.target(self._target.x, self._target.y)
            return super()._bundle()


def _slider(name: str, value_m: float, reach_m: float) -> ipywidgets.FloatSlider:
    return ipywidgets.FloatSlider(
        value=value_m,
        min=-reach_m,
        max=reach_m,
        step=0.01,
        description=f'{name} in m',
        readout_format='.2f',
        layout={'width': '30em'},
    )
