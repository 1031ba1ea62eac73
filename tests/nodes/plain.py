"""Ordinary nodes in one process: `python plain.py NODES [CONTEXTS]`.

Node n publishes on /topic_n, subscribes to the next one's topic and has the service /service_n.
Prints a line when all are made.
"""

import contextlib
import sys
import threading

from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger


class Plain(Node):
    def __init__(self, number, of, **kwargs):
        super().__init__(f'plain_{number}', **kwargs)
        self.publisher = self.create_publisher(String, f'/topic_{number}', 10)
        next_topic = f'/topic_{(number + 1) % of}'
        self.subscription = self.create_subscription(String, next_topic, print, 10)
        self.service = self.create_service(Trigger, f'/service_{number}', self.answer)

    def answer(self, request, response):
        return response


def spin(executor):
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


def main(nodes, contexts=1):
    executors = []
    for _ in range(contexts):
        context = Context()
        context.init()
        executors.append(SingleThreadedExecutor(context=context))
    for number in range(nodes):
        executor = executors[number % contexts]
        executor.add_node(Plain(number, nodes, context=executor.context))
    for executor in executors[1:]:
        threading.Thread(target=spin, args=[executor], daemon=True).start()
    print('up', flush=True)
    spin(executors[0])


if __name__ == '__main__':
    main(*map(int, sys.argv[1:]))
