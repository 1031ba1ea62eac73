"""Checks every pose it receives by FK and IK.

Run it with `ros2 run my_robot_basics kinematics_subscriber`.
"""

import math
import signal

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

from my_robot_basics.two_link_kinematics import forward_kinematics, inverse_kinematics

JOINTS = ('joint1', 'joint2')
SAME_DEG = 1e-3  # degrees; angles that differ by less count as equal


class KinematicsSubscriber(Node):
    """Receives joint angles and logs which of the two IK branches each pose belongs to.

    It logs a warning for a message that does not contain a pose.
    """

    def __init__(self) -> None:
        super().__init__('kinematics_subscriber')
        # Queue depth 10: ten messages may wait for the callback, then the oldest is lost.
        self.subscription = self.create_subscription(
            JointState, '/kinematics/joint_states', self.check_pose, 10
        )
        topic = self.subscription.topic_name  # the full name, after any remapping
        self.get_logger().info(f'waiting for poses on {topic}')

    def check_pose(self, msg: JointState) -> None:
        """Radians → degrees → FK → IK, and compare with both branches."""
        try:
            pose = self.pose_deg(msg)
            x, y = forward_kinematics(*pose)
            solutions = inverse_kinematics(x, y)
        except ValueError as error:
            self.get_logger().warning(f'ignored a message: {error}')
            return
        branches = [name for name, solution in solutions.items() if same_pose(pose, solution)]
        match branches:
            case [branch]:
                verdict = f'IK finds it as {branch}'
            case []:
                verdict = 'IK finds it in neither branch'
            case _:
                verdict = 'IK finds it in both branches, which are one here (stretched or folded)'
        self.get_logger().info(
            f'received θ1={pose[0]:.1f}°, θ2={pose[1]:.1f}° → '
            f'end effector at ({x:.3f}, {y:.3f}) m; {verdict}'
        )

    def pose_deg(self, msg: JointState) -> tuple[float, float]:
        """Return (θ1, θ2) in degrees, found by joint name; ValueError says what is missing."""
        if len(msg.name) != len(msg.position):
            raise ValueError(
                f'{len(msg.name)} names but {len(msg.position)} positions: each joint needs both'
            )
        angles_rad = dict(zip(msg.name, msg.position, strict=True))
        for joint in JOINTS:
            if joint not in angles_rad:
                raise ValueError(f'no {joint} among the names {list(msg.name)}')
            if not math.isfinite(angles_rad[joint]):
                raise ValueError(f'the position of {joint} is {angles_rad[joint]}')
        if [name for name in msg.name if name in JOINTS] != list(JOINTS):
            self.get_logger().warning(
                f'the names come as {list(msg.name)}: the angles are taken by name, not by place'
            )
        return math.degrees(angles_rad['joint1']), math.degrees(angles_rad['joint2'])


def same_pose(pose: tuple[float, float], other: tuple[float, float]) -> bool:
    """Whether two poses in degrees are equal, where 360° counts as 0°."""
    return all(
        abs(math.remainder(a - b, 360.0)) < SAME_DEG for a, b in zip(pose, other, strict=True)
    )


def main(args: list[str] | None = None) -> None:
    """Run the node until Ctrl-C or SIGTERM."""
    # SIGTERM ends the node as Ctrl-C does: rclpy.spin alone sometimes misses it
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        rclpy.init(args=args)
        rclpy.spin(KinematicsSubscriber())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # the normal end
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
