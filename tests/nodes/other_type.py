"""Publishes nothing; its publisher has another type than that of `everything.py` on the topic."""

from five_hz import spin
from rclpy.node import Node
from std_msgs.msg import Int32


class OtherType(Node):
    def __init__(self):
        super().__init__('other_type', start_parameter_services=False)
        self.publisher = self.create_publisher(Int32, '/two_types', 10)
        self.ready = self.create_publisher(Int32, '/_other_type_is_up', 10)


def main():
    spin(OtherType)


if __name__ == '__main__':
    main()
