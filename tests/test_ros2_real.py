"""Our `ros2` and a real ros2cli, if there is one, print the same for the same command."""

import os
import re
import subprocess
import sys

import pytest
from ros2_command import NODES, TIMEOUT_SEC, on_the_graph, own_domain

pytest.importorskip(
    'ros2cli', reason='no ros2cli to compare with: source a ROS 2 Jazzy installation to run this'
)

OURS = 'import sys; from my_robot_basics.ros2 import main; main.find_spec = lambda name: None'
OURS += '; sys.exit(main.main())'
REAL = 'import sys; from ros2cli.cli import main; sys.exit(main())'
DIRECT = '--no-daemon', '--spin-time', '2'
TOPIC = '/kinematics/joint_states'
PARAMETER_FILE = NODES / 'parameters.yaml'

COMMANDS = [
    ('topic', 'list', '-t', *DIRECT),
    ('topic', 'list', '-v', *DIRECT),
    ('topic', 'list', '-c', '--include-hidden-topics', *DIRECT),
    ('topic', 'info', TOPIC, *DIRECT),
    ('topic', 'info', '/two_types', '--verbose', *DIRECT),
    ('topic', 'info', '/nothing', *DIRECT),
    ('topic', 'type', TOPIC, *DIRECT),
    ('topic', 'type', '/nothing', *DIRECT),
    ('topic', 'find', 'std_msgs/msg/String', *DIRECT),
    ('topic', 'echo', '/arm_description', '--once', *DIRECT),
    ('topic', 'echo', TOPIC, '--once', '--field', 'name', *DIRECT),
    ('topic', 'echo', TOPIC, '--once', '--no-arr', '--csv', *DIRECT),
    ('topic', 'echo', TOPIC, '--once', '--flow-style', '-l', '1', *DIRECT),
    ('topic', 'echo', TOPIC, '--field', '.', *DIRECT),
    ('topic', 'echo', '/nothing', *DIRECT),
    ('topic', 'pub', '--once', '-w', '0', '/x', 'std_msgs/msg/String', 'data: hello'),
    ('topic', 'pub', '/x', 'std_msgs/msg/String', '[1]'),
    ('node', 'list', *DIRECT),
    ('node', 'info', '/arm/everything', *DIRECT),
    ('node', 'info', '/nobody', *DIRECT),
    ('service', 'list', '-t', *DIRECT),
    ('service', 'find', 'std_srvs/srv/Trigger'),
    ('service', 'info', '/arm/start', *DIRECT),
    ('service', 'info', '/nothing', *DIRECT),
    ('service', 'type', '/arm/start'),
    ('service', 'call', '/arm/start', 'std_srvs/srv/Trigger'),
    ('service', 'call', '/arm/start', 'std_srvs/Trigger', '[1]'),
    ('service', 'call', '/x', 'std_msgs/msg/String'),
    ('service', 'call', '/x', 'os/path'),
    ('action', 'list', '-t'),
    ('action', 'list', '-c'),
    ('action', 'type', '/arm/move'),
    ('action', 'type', '/nothing'),
    ('action', 'info', '/arm/move', '-t'),
    ('action', 'info', '/arm/move', '-c'),
    ('action', 'info', '/nothing'),
    ('action', 'send_goal', '/arm/move', 'arm_interfaces/action/MoveArm', '{speed: 1}'),
    ('action', 'send_goal', '/x', 'os/path'),
    ('param', 'list', '/arm/everything', '--param-type', *DIRECT),
    ('param', 'get', '/arm/everything', 'some_doubles', *DIRECT),
    ('param', 'get', '/arm/everything', 'some_bytes', '--hide-type', *DIRECT),
    ('param', 'set', '/arm/everything', 'a_string', 'other', *DIRECT),
    ('param', 'get', '/nobody', 'x', *DIRECT),
    ('param', 'dump', '/foo/test_node', *DIRECT),
    ('param', 'dump', '/foo/without_value', *DIRECT),
    ('param', 'dump', '/nobody', *DIRECT),
    ('param', 'describe', '/foo/constrained', 'rate_hz', 'seed', 'robot', *DIRECT),
    ('param', 'describe', '/foo/constrained', 'seed', 'nothing', *DIRECT),
    ('param', 'set', '/foo/constrained', 'even', '3', *DIRECT),
    ('param', 'set', '/foo/constrained', 'rate_hz', '0.5', *DIRECT),
    ('param', 'set', '/foo/constrained', 'rate_hz', '7', *DIRECT),
    ('param', 'set', '/foo/constrained', 'robot', 'other', *DIRECT),
    ('param', 'set', '/foo/constrained', 'nothing', '1', *DIRECT),
    ('param', 'delete', '/foo/constrained', 'even', *DIRECT),
    ('param', 'delete', '/foo/constrained', 'nothing', *DIRECT),
    ('param', 'delete', '/nobody', 'x', *DIRECT),
    ('param', 'load', '/foo/constrained', str(PARAMETER_FILE), *DIRECT),
    ('param', 'load', '/foo/constrained', str(PARAMETER_FILE), '--no-use-wildcard', *DIRECT),
    ('param', 'load', '/nobody', 'x', *DIRECT),
    ('interface', 'list'),
    ('interface', 'package', 'sensor_msgs'),
    ('interface', 'package', 'action_msgs', '-s', '-m'),
    ('interface', 'package', 'no_msgs'),
    ('interface', 'packages'),
    ('interface', 'packages', '-s', '-m'),
    ('interface', 'proto', 'sensor_msgs/msg/JointState'),
    ('interface', 'proto', 'std_srvs/srv/SetBool', '--no-quotes'),
    ('interface', 'show', 'sensor_msgs/msg/JointState'),
    ('interface', 'show', 'sensor_msgs/msg/PointCloud2', '--all-comments'),
    ('interface', 'show', 'sensor_msgs/msg/PointCloud2', '--no-comments'),
    ('interface', 'show', 'std_srvs/srv/SetBool'),
    ('interface', 'show', 'no_msgs/msg/Thing'),
    ('pkg', 'list'),
    ('pkg', 'executables', 'my_robot_basics'),
    ('pkg', 'prefix', 'rclpy'),
    ('pkg', 'prefix', 'nothing'),
    ('run', 'nothing', 'x'),
]


@pytest.fixture(scope='module', autouse=True)
def system():
    topics = '/everything_is_up', TOPIC, '/_other_type_is_up', '/_constrained_is_up'
    nodes = 'everything', 'five_hz', 'other_type', 'parameters'
    with own_domain(), on_the_graph(*nodes, topics=topics):
        yield


@pytest.mark.parametrize('words', COMMANDS, ids=' '.join)
def test_a_command_prints_the_same_as_a_real_ros2cli(words):
    assert answer(OURS, words) == answer(REAL, words)


def answer(program, words):
    done = subprocess.run(
        [sys.executable, '-c', program, *words],
        capture_output=True,
        encoding='utf-8',
        timeout=TIMEOUT_SEC,
        env=os.environ,
    )
    # what differs from message to message, and where two endpoints may come in either order
    text = re.sub(r'-?\d+\.\d+(e-\d+)?|[0-9a-f]{32}|\d{9,}', 'NUMBER', done.stdout)
    sections = sorted(re.sub(r'nanosec: \d+', '', text).split('\n\n'))
    return sections, done.stderr, done.returncode
