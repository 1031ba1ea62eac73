"""Publishes nothing, and makes publishers and services until it is stopped."""

import threading

import rclpy
from rcl_interfaces.srv import SetParameters
from std_msgs.msg import Empty

KinematicsPublisher.publish = lambda self: None


def make():
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node('flood', context=context)
    made = []
    while True:
        made.append(node.create_publisher(Empty, f'/flood/t{len(made)}', 1))
        name = f'/flood{len(made)}/set_parameters'
        made.append(node.create_service(SetParameters, name, lambda request, response: response))


threading.Thread(target=make, daemon=True).start()
