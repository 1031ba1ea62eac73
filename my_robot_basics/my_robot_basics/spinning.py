"""What every `main` of this package does: run one node until it is told to stop."""

import signal
from collections.abc import Callable

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions


def spin_until_stopped(node_class: Callable[[], Node], *, args: list[str] | None = None) -> None:
    """Make a node and spin it until Ctrl-C or SIGTERM; then clean up and return.

    Does what `rclpy.init` and `rclpy.spin` do, without the traceback in which these end at either
    signal. It is for the main thread of a process of its own; an error of the node's is raised.
    """
    stop_signals = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: stop_signals.append(number))
    # rclpy's own handlers would take the context away from a node that is only half made.
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = node_class()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while rclpy.ok() and not stop_signals:
            executor.spin_once(timeout_sec=0.1)  # a longer wait would notice a signal later
        executor.shutdown()
        node.destroy_node()
    finally:
        rclpy.try_shutdown()
