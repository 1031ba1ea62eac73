"""Publishes joint states at 5 Hz from a timer: what the exercise asks for."""

import math
import random

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class FiveHz(Node):
    def __init__(self, name='kinematics_publisher', period_sec=0.2, **kwargs):
        super().__init__(name, **kwargs)
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
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


def main():
    rclpy.init()
    rclpy.spin(FiveHz())


if __name__ == '__main__':
    main()
