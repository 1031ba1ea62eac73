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

_announced: list[Node] = []


def announce() -> None:
    """Publish one transient-local message, which is available until `remove_announcement`."""
    node = _node('_probe_student_room', _new_context())
    node.create_publisher(Empty, TOPIC_NAME, QOS).publish(Empty())
    _announced.append(node)


def remove_announcement() -> None:
    """Remove the announcement, its node and its context."""
    while _announced:
        node = _announced.pop()
        node.destroy_node()
        node.context.try_shutdown()


def receive(timeout_sec: float = TIMEOUT_SEC, *, context: Context | None = None) -> None:
    """Wait for the other room's message; raises TimeoutError if it does not arrive in time.

    The node is in `context`; without one, it gets a context of its own, which ends with it.
    """
    owned = context is None
    context = context or _new_context()
    node = _node('_probe_test_room', context)
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
        node.destroy_node()
        if owned:
            context.try_shutdown()


def _new_context() -> Context:
    classroom.enter()
    context = Context()
    rclpy.init(context=context)
    return context


def _node(name: str, context: Context) -> Node:
    return rclpy.create_node(
        name, context=context, start_parameter_services=False, enable_rosout=False
    )
