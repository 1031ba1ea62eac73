"""The smallest node: says hello once. Run it with `ros2 run my_robot_basics hello_node`."""

import signal

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class HelloNode(Node):
    """Logs one line and keeps running until it is stopped."""

    def __init__(self) -> None:
        super().__init__('hello_node')
        self.get_logger().info('Hello, ROS 2! Stop me with Ctrl-C')


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    # SIGTERM ends the node as Ctrl-C does: rclpy.spin alone sometimes misses it
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        rclpy.init(args=args)
        rclpy.spin(HelloNode())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # the normal end
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
