"""Publishes a random pose of the arm every second.

Run it with `ros2 run my_robot_basics kinematics_publisher`.
"""

import math
import random
import signal

import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

from my_robot_basics.two_link_kinematics import forward_kinematics


class KinematicsPublisher(Node):
    """Publishes joint angles on /kinematics/joint_states once a second.

    θ1 is within ±90° and θ2 within ±120°. The parameter `seed` fixes the sequence of poses;
    if it is not given, it is chosen at random.
    """

    def __init__(self, seed: int | None = None) -> None:
        super().__init__('kinematics_publisher')
        seed = random.randrange(2**31) if seed is None else seed
        fixed = ParameterDescriptor(description='Seed of the random poses', read_only=True)
        self.declare_parameter('seed', seed, fixed)
        self.random = random.Random(self.get_parameter('seed').value)
        # Queue depth 10: ten messages may wait for a slow subscription, then the oldest is lost.
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.timer = self.create_timer(1.0, self.publish_pose)  # the period, in seconds
        topic = self.publisher.topic_name  # the full name, after any remapping
        self.get_logger().info(f'publishing a random pose on {topic} every second')

    def publish_pose(self) -> None:
        """Choose a pose, publish it in radians, and log it in degrees."""
        theta1_deg = self.random.uniform(-90.0, 90.0)
        theta2_deg = self.random.uniform(-120.0, 120.0)

        msg = JointState()
        msg.header.stamp = self.get_clock().now().to_msg()  # when the pose was taken
        msg.header.frame_id = 'base_link'
        msg.name = ['joint1', 'joint2']  # the names of the joints in the robot's URDF
        msg.position = [math.radians(theta1_deg), math.radians(theta2_deg)]
        self.publisher.publish(msg)

        x, y = forward_kinematics(theta1_deg, theta2_deg)
        self.get_logger().info(
            f'published θ1={theta1_deg:.1f}°, θ2={theta2_deg:.1f}° → '
            f'end effector at ({x:.3f}, {y:.3f}) m'
        )


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    # SIGTERM ends the node as Ctrl-C does: rclpy.spin alone sometimes misses it
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        rclpy.init(args=args)
        rclpy.spin(KinematicsPublisher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # the normal end
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
