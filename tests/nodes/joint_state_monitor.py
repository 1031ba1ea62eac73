"""Relays a BEST_EFFORT sensor and a latched description, with QoS that matches what is offered."""

import contextlib

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import JointState
from std_msgs.msg import String

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class JointStateMonitor(Node):
    def __init__(self, *, sensor=qos_profile_sensor_data, description=LATCHED, monitor=10):
        super().__init__('joint_state_monitor')
        self.pass_on(JointState, '/sensor/joint_states', '/monitor/joint_states', sensor, monitor)
        self.pass_on(String, '/arm_description', '/monitor/arm_description', description, monitor)

    def pass_on(self, type_, source, to, asked, offered):
        publisher = self.create_publisher(type_, to, offered)
        self.create_subscription(type_, source, self.changed(publisher.publish), asked)

    def changed(self, publish):
        return publish


def spin(node_class, **kwargs):
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node_class(**kwargs))


if __name__ == '__main__':
    spin(JointStateMonitor)
