"""What every `main` of this package does: run one node until it is told to stop."""

import signal
from collections.abc import Callable

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


def spin_until_stopped(node_class: Callable[[], Node], *, args: list[str] | None = None) -> None:
    """Make a node and spin it until Ctrl-C or SIGTERM; then clean up and return.

    `rclpy.spin` alone ends in a traceback at either signal. An error of the node's own is raised.
    """
    stop_signals = []
    # rclpy's handlers shut its context down, which ends `spin`, and call these afterwards.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: stop_signals.append(number))
    rclpy.init(args=args)
    try:
        if not stop_signals:  # one may have come before rclpy was listening
            rclpy.spin(node_class())
    except ExternalShutdownException:
        pass
    except Exception:
        if not stop_signals:  # a context that goes away stops a half-made node with odd errors
            raise
    finally:
        rclpy.try_shutdown()
