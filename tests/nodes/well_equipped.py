"""Publishes at 5 Hz, and has what real nodes have: a slower timer, a service, its own topic."""

from five_hz import FiveHz, spin
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger


class WellEquipped(FiveHz):
    def __init__(self):
        super().__init__()
        self.create_timer(1.0, self.report)
        self.create_subscription(JointState, '/kinematics/joint_states', self.count, 10)
        self.create_publisher(JointState, '/kinematics/joint_states_raw', 10)
        self.create_service(Trigger, '/report', self.answer)
        self.received = 0

    def count(self, message):
        self.received += 1

    def report(self):
        self.get_logger().info(f'received {self.received} of my own messages')

    def answer(self, request, response):
        response.success = True
        return response


if __name__ == '__main__':
    spin(WellEquipped)
