"""Publishes joint states at 5 Hz from a timer: what the exercise asks for.

The other nodes of this folder change one thing about it. Each runs on its own
(`python five_hz.py`), or is imported with its one Node class.
"""

import contextlib
import math
import random

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class FiveHz(Node):
    def __init__(self, name='kinematics_publisher', *, period_sec=0.2, **kwargs):
        super().__init__(name, **kwargs)
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.start(period_sec)

    def start(self, period_sec):
        self.timer = self.create_timer(period_sec, self.publish)

    def publish(self):
        self.publisher.publish(self.joint_state())

    def joint_state(self):
        message = JointState(name=['joint1', 'joint2'])
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'base_link'
        pose_deg = random.uniform(-90.0, 90.0), random.uniform(-120.0, 120.0)
        message.position = [math.radians(angle) for angle in pose_deg]
        return message


def spin(node_class, **kwargs):
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node_class(**kwargs))


def main():
    spin(FiveHz)


if __name__ == '__main__':
    main()
