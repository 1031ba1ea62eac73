"""Asks /solve_ik for each target and publishes the elbow-up answer: the exercise's answer."""

from five_hz import spin
from geometry_msgs.msg import Point
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int64

from arm_interfaces.srv import SolveIK


class IKClient(Node):
    def __init__(self, **kwargs):
        super().__init__('ik_client', **kwargs)
        self.client = self.create_client(SolveIK, '/solve_ik')
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.create_subscription(Point, '/target_point', self.ask, 10)
        self.count = 0
        self.counter = self.create_publisher(Int64, '/ik_client/alive', 10)
        self.create_timer(0.1, self.say_alive)

    def say_alive(self):
        self.count += 1
        self.counter.publish(Int64(data=self.count))

    def ask(self, target):
        future = self.client.call_async(SolveIK.Request(target=target))
        future.add_done_callback(lambda future: self.answer(future.result()))

    def answer(self, response):
        if response is not None and response.reachable:
            self.send(response.elbow_up)

    def send(self, position):
        message = JointState(name=['joint1', 'joint2'], position=position)
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'base_link'
        self.publisher.publish(message)


def main():
    spin(IKClient)


if __name__ == '__main__':
    main()
