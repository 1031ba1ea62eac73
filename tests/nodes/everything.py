"""A node in a namespace with one of everything that the `ros2` command can show."""

import array

from five_hz import spin
from rclpy.action import ActionServer
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import Trigger

from arm_interfaces.action import MoveArm

PARAMETERS = {
    'a_bool': True,
    'an_integer': 3,
    'a_double': 0.5,
    'a_string': 'text',
    'some_bytes': [b'a', b'b'],
    'some_bools': [True, False],
    'some_integers': array.array('q', [1, 2]),
    'some_doubles': array.array('d', [0.5, 1.5]),
    'some_strings': ['a', 'b'],
}


class Everything(Node):
    def __init__(self):
        super().__init__('everything', namespace='/arm')
        for name, value in PARAMETERS.items():
            self.declare_parameter(name, value)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.description = self.create_publisher(String, '/arm_description', latched)
        self.description.publish(String(data='two links'))
        self.hidden = self.create_publisher(String, '/_hidden', 10)
        self.text = self.create_publisher(String, '/two_types', 10)
        self.heard = self.create_subscription(String, '/heard', print, 10)
        self.own_client = self.create_client(Trigger, 'start')
        self.service = self.create_service(Trigger, 'start', lambda request, response: response)
        self.mover = ActionServer(self, MoveArm, 'move', lambda handle: MoveArm.Result())
        self.ready = self.create_publisher(String, '/everything_is_up', 10)


def main():
    spin(Everything)


if __name__ == '__main__':
    main()
