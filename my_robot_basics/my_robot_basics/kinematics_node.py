"""Computes one pose and its inverse. Run it with `ros2 run my_robot_basics kinematics_node`.

It only logs the result, so no other node can use it: for that, a node needs a topic.
"""

import signal

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from my_robot_basics.two_link_kinematics import forward_kinematics, inverse_kinematics


class KinematicsNode(Node):
    """Logs the end effector's position for one pose, then both poses that reach that position."""

    def __init__(self) -> None:
        super().__init__('kinematics_node')
        theta1_deg, theta2_deg = 23.4, -67.8
        x, y = forward_kinematics(theta1_deg, theta2_deg)
        self.get_logger().info(
            f'FK: θ1={theta1_deg:.1f}°, θ2={theta2_deg:.1f}° → ({x:.3f}, {y:.3f}) m'
        )
        for branch, (theta1_deg, theta2_deg) in inverse_kinematics(x, y).items():
            self.get_logger().info(
                f'IK: ({x:.3f}, {y:.3f}) m → {branch}: θ1={theta1_deg:.1f}°, θ2={theta2_deg:.1f}°'
            )


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    # SIGTERM ends the node as Ctrl-C does: rclpy.spin alone sometimes misses it
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        rclpy.init(args=args)
        rclpy.spin(KinematicsNode())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # the normal end
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
