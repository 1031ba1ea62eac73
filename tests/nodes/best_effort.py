"""Offers BEST_EFFORT: a RELIABLE subscription would receive nothing."""

from five_hz import FiveHz, spin
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState


class BestEffort(FiveHz):
    def start(self, period_sec):
        self.destroy_publisher(self.publisher)
        offer = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', offer)
        super().start(period_sec)


def main():
    spin(BestEffort)


if __name__ == '__main__':
    main()
