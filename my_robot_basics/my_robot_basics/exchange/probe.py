"""Check that a message gets from room to room before any student code runs.

The student's room publishes and the test's room receives: so the network cannot cause a zero.
"""

import threading

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Empty

from my_robot_basics.session import classroom

TOPIC_NAME = '/_probe'
QOS = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
TIMEOUT_SEC = 20.0

_announced: list = []


def announce() -> None:
    """Publish one transient-local message, which is available until `remove_announcement`."""
    context, node = _node('_probe_student_room')
    node.create_publisher(Empty, TOPIC_NAME, QOS).publish(Empty())
    _announced.append((context, node))


def remove_announcement() -> None:
    """Remove the announcement, its node and its context."""
    while _announced:
        _end(*_announced.pop())


def receive(timeout_sec: float = TIMEOUT_SEC) -> None:
    """Wait for the other room's message; raises TimeoutError if it does not arrive in time."""
    context, node = _node('_probe_test_room')
    received = threading.Event()
    node.create_subscription(Empty, TOPIC_NAME, lambda _: received.set(), QOS)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    deadline = node.get_clock().now().nanoseconds + int(timeout_sec * 1e9)
    try:
        while not received.is_set():
            if node.get_clock().now().nanoseconds > deadline:
                raise TimeoutError(f'no message went from kernel to kernel in {timeout_sec:.0f} s')
            executor.spin_once(timeout_sec=0.1)
    finally:
        executor.shutdown()
        _end(context, node)


def _node(name: str) -> tuple[Context, Node]:
    classroom.enter()
    context = Context()
    rclpy.init(context=context)
    node = rclpy.create_node(
        name, context=context, start_parameter_services=False, enable_rosout=False
    )
    return context, node


def _end(context: Context, node: Node) -> None:
    node.destroy_node()
    context.try_shutdown()
