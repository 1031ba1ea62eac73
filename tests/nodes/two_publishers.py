"""One node with two publishers on the topic."""

from five_hz import FiveHz, spin
from sensor_msgs.msg import JointState


class TwoPublishers(FiveHz):
    def start(self, period_sec):
        super().start(period_sec)
        self.other = self.create_publisher(JointState, '/kinematics/joint_states', 10)


def main():
    spin(TwoPublishers)


if __name__ == '__main__':
    main()
