"""A healthy publisher and subscription as source: a fault replaces a line, a fix puts one in."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator

TOPIC = '/kinematics/joint_states'
PUBLISHER = f"self.publisher = self.create_publisher(JointState, '{TOPIC}', 10)"
SUBSCRIPTION = (
    f"self.subscription = self.create_subscription(JointState, '{TOPIC}', self.receive, 10)"
)
TIMER = 'self.timer = self.create_timer(0.2, self.publish)'
STAMP = 'message.header.stamp = self.get_clock().now().to_msg()'
CONVERT = 'message.position = [math.radians(angle) for angle in message.position]'
SEND = 'self.publisher.publish(message)'
RECEIVE = 'self.heard.append(message)'
SPIN = 'rclpy.spin(node)'

IMPORTS = """
import math
import time
import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import String
"""
TALKER = f"""{IMPORTS}
class Talker(Node):
    def __init__(self, **kwargs):
        super().__init__('talker', **kwargs)
        {PUBLISHER}
        {TIMER}

    def publish(self):
        message = JointState(name=['joint1', 'joint2'], position=[23.4, -67.8])
        {STAMP}
        {CONVERT}
        {SEND}
"""
LISTENER = f"""{IMPORTS}
class Listener(Node):
    def __init__(self, **kwargs):
        super().__init__('listener', **kwargs)
        self.heard = []
        {SUBSCRIPTION}

    def receive(self, message):
        {RECEIVE}
"""
MAIN = f"""
rclpy.init()
node = {{}}()
{SPIN}
"""
END_SEC = 20.0
"""How long a process may take to end, on a busy machine."""


def edited(source: str, *edits: tuple[str, str]) -> str:
    """The source with each edit's line in place of its former one."""
    for line, instead in edits:
        assert line in source
        source = source.replace(line, instead)
    return source


def node_class(source: str, *edits: tuple[str, str]) -> type:
    """The class of an edited source."""
    names = {'__name__': '__main__'}
    exec(edited(source, *edits), names)
    return names['Talker' if source is TALKER else 'Listener']


def program(source: str, *edits: tuple[str, str]) -> list[str]:
    """The command that runs the node of an edited source in a process of its own."""
    name = 'Talker' if source is TALKER else 'Listener'
    return [sys.executable, '-c', edited(source + MAIN.format(name), *edits)]


@contextlib.contextmanager
def process(command: list[str], **environment: str) -> Iterator[None]:
    """Run a command for the duration of a with statement."""
    started = subprocess.Popen(
        command,
        env=os.environ | environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield
    finally:
        started.terminate()
        try:
            started.wait(END_SEC)
        except subprocess.TimeoutExpired:  # rclpy may lose a signal that comes as it begins
            started.kill()
            started.wait()
