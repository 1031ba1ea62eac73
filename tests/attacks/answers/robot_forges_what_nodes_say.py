"""Runs at 1 Hz, and forges log records and the check's probe in the names of other nodes."""  # earns 2

import threading
import time

import rclpy
from rcl_interfaces.msg import Log
from std_msgs.msg import Empty, String


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
