"""A correct node that is never spun."""

import time

import rclpy
from five_hz import FiveHz


class NeverSpins(FiveHz):
    pass


def main():
    rclpy.init()
    node = NeverSpins()
    while node.context.ok():
        time.sleep(0.1)


if __name__ == '__main__':
    main()
