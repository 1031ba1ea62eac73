"""The smallest node: says hello once. Run it with `ros2 run my_robot_basics hello_node`."""

from rclpy.node import Node

from my_robot_basics.spinning import spin_until_stopped


class HelloNode(Node):
    """Logs one line and stays, until it is stopped."""

    def __init__(self) -> None:
        super().__init__('hello_node')
        self.get_logger().info('Hello, ROS 2! Stop me with Ctrl-C')


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    spin_until_stopped(HelloNode, args=args)


if __name__ == '__main__':
    main()
