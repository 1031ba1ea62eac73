"""Runs at 1 Hz, and calls every parameter service of every other node."""  # earns 2

import threading
import time

import rclpy
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter


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
