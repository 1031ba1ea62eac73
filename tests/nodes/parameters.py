"""A node of parameters: those of ros2cli's own tests, and some with constraints."""

import contextlib

import rclpy
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Empty

PARAMETERS = {
    'bool_param': True,
    'int_param': 42,
    'double_param': 1.23,
    'str_param': 'Hello World',
    'bool_array_param': [False, False, True],
    'int_array_param': [1, 2, 3],
    'str_array_param': ['foo', 'bar', 'baz'],
    'double_array_param': [3.125, 6.25, 12.5],
    'foo.str_param': 'foo',
    'foo.bar.str_param': 'foobar',
}


class TestNode(Node):
    def __init__(self):
        super().__init__('test_node', namespace='/foo')
        for name, value in PARAMETERS.items():
            self.declare_parameter(name, value)
        self.ready = self.create_publisher(Empty, '/_test_node_is_up', 10)


class Constrained(Node):
    def __init__(self):
        super().__init__('constrained', namespace='/foo')
        descriptions = {
            'rate_hz': ParameterDescriptor(
                description='Messages a second',
                floating_point_range=[FloatingPointRange(from_value=1.0, to_value=50.0)],
            ),
            'seed': ParameterDescriptor(
                integer_range=[IntegerRange(from_value=0, to_value=100, step=5)],
                additional_constraints='not 13',
            ),
            'robot': ParameterDescriptor(read_only=True),
            'any': ParameterDescriptor(dynamic_typing=True),
        }
        values = {'rate_hz': 5.0, 'seed': 0, 'robot': 'two_link_arm', 'any': 1, 'even': 2}
        for name, value in values.items():
            self.declare_parameter(name, value, descriptions.get(name, ParameterDescriptor()))
        self.add_on_set_parameters_callback(self.judge)
        self.ready = self.create_publisher(Empty, '/_constrained_is_up', 10)

    def judge(self, parameters):
        odd = [p.value for p in parameters if p.name == 'even' and p.value % 2]
        reason = f'even must be even, got {odd[0]}' if odd else 'as you like'
        return SetParametersResult(successful=not odd, reason=reason)


def without_value():
    node = Node('without_value', namespace='/foo')
    node.declare_parameter('speed', Parameter.Type.DOUBLE)
    return node


def tangled():
    node = Node('tangled', namespace='/foo')
    node.declare_parameter('arm', 1)
    node.declare_parameter('arm.speed', 2)
    return node


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for make in (without_value, tangled, Constrained, TestNode):
        executor.add_node(make())
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
