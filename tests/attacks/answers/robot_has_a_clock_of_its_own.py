"""Runs at 1 Hz, and drives a /clock of its own five times too fast."""  # earns 2

import random
import threading
import time

import rclpy
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState


class KinematicsPublisher(Node):
    def __init__(self):
        super().__init__('kinematics_publisher')
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.timer = self.create_timer(1.0, self.publish)

    def publish(self):
        message = JointState(name=['joint1', 'joint2'])
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'base_link'
        message.position = [random.uniform(-1.5, 1.5), random.uniform(-2.0, 2.0)]
        self.publisher.publish(message)


def drive():
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node('clock', context=context)
    clock = node.create_publisher(Clock, '/clock', 10)
    nanoseconds = time.time_ns()
    while True:
        nanoseconds += 50_000_000
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(nanoseconds, 10**9)
        clock.publish(message)
        time.sleep(0.01)


threading.Thread(target=drive, daemon=True).start()
