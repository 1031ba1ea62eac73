"""An honest client; the code of an attack `client_…` is appended to it."""

from geometry_msgs.msg import Point
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32

from arm_interfaces.srv import SolveIK


class IKClient(Node):
    def __init__(self):
        super().__init__('ik_client')
        self.alive, self.count = self.create_publisher(Int32, '/ik_client/alive', 10), 0
        self.counting = self.create_timer(0.1, self.say_alive)
        self.client = self.create_client(SolveIK, '/solve_ik')
        self.publisher = self.create_publisher(JointState, '/kinematics/joint_states', 10)
        self.create_subscription(Point, '/target_point', self.ask, 10)

    def say_alive(self):
        self.count += 1
        self.alive.publish(Int32(data=self.count))

    def ask(self, target):
        future = self.client.call_async(SolveIK.Request(target=target))
        future.add_done_callback(lambda future: self.receive(target, future.result()))

    def receive(self, target, response):
        if response.reachable:
            self.send(response.elbow_up)

    def send(self, position):
        message = JointState(name=['joint1', 'joint2'], position=position)
        message.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)
