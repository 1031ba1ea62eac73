"""Publishes from a thread and never spins: its parameter services never respond."""

import time

import rclpy
from sleep_loop import SleepLoop


class Unresponsive(SleepLoop):
    pass


def main():
    rclpy.init()
    node = Unresponsive()
    while node.context.ok():
        time.sleep(0.1)


if __name__ == '__main__':
    main()
