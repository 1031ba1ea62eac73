"""Publishes on a topic whose name is misspelt."""

from five_hz import FiveHz, spin
from sensor_msgs.msg import JointState


class WrongTopic(FiveHz):
    def start(self, period_sec):
        self.destroy_publisher(self.publisher)
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_state', 10)
        super().start(period_sec)


def main():
    spin(WrongTopic)


if __name__ == '__main__':
    main()
