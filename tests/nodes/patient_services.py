"""A healthy server and client as source: a fault replaces a line, a fix puts one in."""

import sys

from nodes.patient import edited

NAME = '/close_gripper'
SERVICE = f"self.service = self.create_service(SetBool, '{NAME}', self.answer)"
CLIENT = f"self.client = self.create_client(SetBool, '{NAME}')"
IN_GROUP = f'{CLIENT[:-1]}, callback_group=group)'
WORK = 'time.sleep(0.0)'
RETURN = 'return response'
ASK = 'self.client.call_async(request).add_done_callback(self.receive)'
IF_READY = 'if self.client.service_is_ready():'
DEF_ASK = 'def ask(self):'
SPIN = 'rclpy.spin(node)'

IMPORTS = """
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from std_srvs.srv import SetBool, Trigger
"""
SERVER = f"""{IMPORTS}
class Server(Node):
    def __init__(self, **kwargs):
        super().__init__('server', **kwargs)
        self.taken = 0
        {SERVICE}

    def answer(self, request, response):
        self.taken += 1
        {WORK}
        {RETURN}
"""
ASKER = f"""{IMPORTS}
class Asker(Node):
    def __init__(self, group=None, timer_group=None, **kwargs):
        super().__init__('asker', **kwargs)
        self.answered = 0
        {IN_GROUP}
        self.timer = self.create_timer(0.1, self.ask, callback_group=timer_group or group)

    {DEF_ASK}
        {IF_READY}
            self.timer.cancel()
            request = SetBool.Request()
            {ASK}

    def receive(self, future):
        self.answered += 1
"""
MAIN = f"""
rclpy.init()
node = {{}}()
{SPIN}
"""


def node_class(source: str, *edits: tuple[str, str]) -> type:
    """The class of an edited source."""
    names = {'__name__': '__main__'}
    exec(edited(source, *edits), names)
    return names['Server' if source is SERVER else 'Asker']


def program(source: str, *edits: tuple[str, str]) -> list[str]:
    """The command that runs the node of an edited source in a process of its own."""
    name = 'Server' if source is SERVER else 'Asker'
    return [sys.executable, '-c', edited(source + MAIN.format(name), *edits)]
