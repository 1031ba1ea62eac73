"""Spins in a MultiThreadedExecutor of four threads."""

import contextlib

import rclpy
from five_hz import FiveHz
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor


class Multithreaded(FiveHz):
    pass


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Multithreaded())
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
