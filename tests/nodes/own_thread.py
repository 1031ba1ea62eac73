"""Spins in a thread of its own, in a context of its own."""

import contextlib
import threading

from five_hz import FiveHz
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor


class OwnThread(FiveHz):
    pass


def start():
    context = Context()
    context.init()
    node = OwnThread(context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)

    def spin():
        with contextlib.suppress(ExternalShutdownException):
            executor.spin()

    thread = threading.Thread(target=spin)
    thread.start()
    return node, executor, thread


def main():
    _, _, thread = start()
    thread.join()


if __name__ == '__main__':
    main()
