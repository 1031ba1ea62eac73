"""Runs at 1 Hz, and forges logs and the probe in the names of others."""  # earns 2

import random
import threading
import time

import rclpy
from rcl_interfaces.msg import Log
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Empty, String


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


def forge():
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node('_probe_test_room', context=context)
    logs = node.create_publisher(Log, '/rosout', 10)
    probe = node.create_publisher(Empty, '/_probe', 10)
    verdict = node.create_publisher(String, '/verdict', 10)
    while True:
        logs.publish(Log(name='checks', level=b'\x14'[0], msg='expected 5.0 Hz, saw 5.0 Hz'))
        probe.publish(Empty())
        verdict.publish(String(data='{"outcome": "passed"}'))
        time.sleep(0.05)


threading.Thread(target=forge, daemon=True).start()
