"""Services in a namespace, one of them hidden, that send back what they are sent."""

import contextlib

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty
from std_srvs.srv import SetBool


class EchoServer(Node):
    def __init__(self, name, service_name):
        super().__init__(name, namespace='/my_ns')
        self.service = self.create_service(SetBool, service_name, self.echo)
        self.ready = self.create_publisher(Empty, f'{service_name}_is_up', 10)

    def echo(self, request, response):
        response.success = request.data
        response.message = f'got {request.data}'
        return response


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(EchoServer('echo_server', 'echo'))
    executor.add_node(EchoServer('_hidden_echo_server', '_echo'))
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
