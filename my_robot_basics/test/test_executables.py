"""The nodes as processes: how they start, and how they end."""

import importlib
import inspect
import signal
import subprocess
import sys
from pathlib import Path

import pytest

EXECUTABLES = ['hello_node', 'kinematics_node', 'kinematics_publisher', 'kinematics_subscriber']
BIN = Path(sys.executable).parent


@pytest.fixture
def start():
    processes = []

    def start(*command):
        process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding='utf-8'
        )
        processes.append(process)
        return process

    yield start
    for process in processes:
        process.kill()
        process.wait()


def output(process):
    return process.communicate(timeout=30)[0]


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize('executable', EXECUTABLES)
def test_a_signal_ends_a_spinning_executable_cleanly(start, executable, number):
    process = start(BIN / executable)
    assert f'[{executable}]: ' in process.stdout.readline()
    # only a node that spins answers, once it has been discovered
    ask = (BIN / 'ros2', 'param', 'get', f'/{executable}', 'use_sim_time')
    answers = (output(start(*ask)) for _ in range(30))
    assert any('False' in answer for answer in answers)
    process.send_signal(number)
    rest = output(process)
    assert process.returncode == 0
    assert all(f'[{executable}]: ' in line for line in rest.splitlines()), rest


START_UP = """
import os, signal, sys
import rclpy
from rclpy.node import Node
from my_robot_basics import hello_node

moment, number = sys.argv[1], getattr(signal, sys.argv[2])

def at(now):
    if now == moment:
        os.kill(os.getpid(), number)

class SlowNode(Node):
    def __init__(self):
        at('before the node')
        super().__init__('slow_node')
        at('in the node')
        self.create_timer(0.01, lambda: at('in a callback'))

init = rclpy.init
def observed_init(**arguments):
    at('before init')
    init(**arguments)
    at('after init')
rclpy.init = observed_init

hello_node.HelloNode = SlowNode
hello_node.main()
"""


@pytest.mark.parametrize('number', ['SIGINT', 'SIGTERM'])
@pytest.mark.parametrize(
    'moment', ['before init', 'after init', 'before the node', 'in the node', 'in a callback']
)
def test_a_signal_at_any_moment_ends_a_node(start, moment, number):
    """The node ends soon; what it prints while it starts is rclpy's own affair.

    rclpy's handlers shut the context down in another thread, at any point of the node's start.
    """
    process = start(sys.executable, '-c', START_UP, moment, number)
    output(process)
    assert process.returncode in (0, 1)


PROGRAM = """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        rclpy.init(args=args)
        rclpy.spin({node_class}())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # the normal end
    finally:
        rclpy.try_shutdown()
"""


@pytest.mark.parametrize('executable', EXECUTABLES)
def test_each_node_has_the_plain_main_function_of_a_ros_program(executable):
    """Students copy these files: no helper of the course stands between them and rclpy."""
    module = importlib.import_module(f'my_robot_basics.{executable}')
    node_class = next(
        name
        for name, value in vars(module).items()
        if isinstance(value, type) and value.__module__ == module.__name__
    )
    assert inspect.getsource(module.main).endswith(PROGRAM.format(node_class=node_class))


MAIN = """
import rclpy
from rclpy.node import Node
from my_robot_basics import hello_node

class SomeNode(Node):
    def __init__(self):
        super().__init__('some_node')
        self.create_timer(0.01, self.callback)

    def callback(self):
        {callback}

hello_node.HelloNode = SomeNode
hello_node.main()
"""


def test_an_exception_in_a_node_is_printed_and_fails_the_process(start):
    process = start(sys.executable, '-c', MAIN.format(callback='raise LookupError("no arm")'))
    assert 'LookupError: no arm' in output(process)
    assert process.returncode == 1


def test_a_node_may_end_itself(start):
    process = start(sys.executable, '-c', MAIN.format(callback='rclpy.shutdown()'))
    assert output(process) == ''
    assert process.returncode == 0


def test_the_subscriber_receives_poses_of_the_publisher(start):
    start(BIN / 'kinematics_publisher')
    subscriber = start(BIN / 'kinematics_subscriber')
    lines = [subscriber.stdout.readline() for _ in range(3)]
    assert 'waiting for poses' in lines[0]
    assert all('IK finds it as elbow_' in line for line in lines[1:])
