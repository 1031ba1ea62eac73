"""Gives no remap rule: nodes in the notebook have the names, topics and poses instead."""

import math
import random

from my_robot_basics.live import run
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Arm(Node):
    def __init__(self, side, seed):
        super().__init__('arm', namespace=f'/{side}')
        self.declare_parameter('seed', seed)
        self.random = random.Random(seed)
        self.poses = self.create_publisher(JointState, f'/{side}/joint_states', 10)
        self.create_timer(1.0, self.publish)

    def publish(self):
        pose_deg = self.random.uniform(-90.0, 90.0), self.random.uniform(-120.0, 120.0)
        position = [math.radians(angle) for angle in pose_deg]
        self.poses.publish(JointState(name=['joint1', 'joint2'], position=position))


run(Arm, 'left', 1, key='left')
run(Arm, 'right', 7, key='right')
left_arm = right_arm = 'ros2 run my_robot_basics kinematics_publisher --ros-args'
