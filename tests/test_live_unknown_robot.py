"""The robot of lesson 5's exercise: the nodes on its topic, and what its locked cells do."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from my_robot_basics.live import unknown_robot

ROOT = Path(__file__).parents[1]

START = """
import json
import rclpy
from rclpy.node import Node
from my_robot_basics.checks import graph
from my_robot_basics.live import reset, run, stop, wait_until
from my_robot_basics.live.unknown_robot import TOPIC, start_unknown_robot
from sensor_msgs.msg import JointState

reset('endpoints')
start_unknown_robot()
"""


def printed_by(source):
    """The lines that a lesson prints which starts the robot and then runs this source."""
    run = subprocess.run(
        [sys.executable, '-c', START + source], capture_output=True, text=True, check=True
    )
    assert run.stderr == ''
    return run.stdout.splitlines()[2:]


@pytest.mark.starts
def test_the_robots_nodes_are_on_the_topic_as_the_check_expects():
    [said] = printed_by(
        'print(json.dumps([graph().publishers(TOPIC), graph().subscriptions(TOPIC)]))'
    )
    publishers, subscriptions = json.loads(said)
    assert publishers == ['/encoder_board', '/self_test']
    assert subscriptions == ['/motor_guard', '/pose_logger', '/self_test', '/tool_tracker']


@pytest.mark.starts
def test_the_topic_of_the_robot_carries_messages():
    assert printed_by(
        'listener, heard = run(Node, "listener"), []\n'
        'listener.create_subscription(JointState, TOPIC, heard.append, 10)\n'
        'wait_until(lambda: heard)\n'
        'print(list(heard[0].name), heard[0].header.stamp.sec > 0)'
    ) == ["['joint1', 'joint2'] True"]


@pytest.mark.starts
def test_starting_the_robot_again_keeps_or_restores_its_8_nodes():
    names = 'print(len(graph().nodes()))\n'
    assert printed_by(
        f'start_unknown_robot()\n{names}stop()\n{names}start_unknown_robot()\n{names}'
        f'rclpy.shutdown()\nstart_unknown_robot()\n{names}'
    ) == [
        *('the unknown robot runs: 8 nodes', '8'),
        '0',
        *('the unknown robot runs: 8 nodes', '8') * 2,
    ]


@pytest.mark.starts
def test_a_node_that_is_not_part_of_the_robot_is_named_in_a_note():
    said = printed_by(
        'other = run(Node, "kinematics_publisher")\n'
        'other.create_publisher(JointState, TOPIC, 10)\n'
        'wait_until(lambda: other.count_publishers(TOPIC) == 3)\n'
        'start_unknown_robot()'
    )
    assert said[1].startswith(
        f'note: kinematics_publisher is on {unknown_robot.TOPIC} and is not part of it'
    )


NAMES = ['encoder_board', 'self_test', 'motor_guard', 'pose_logger', 'tool_tracker']


@pytest.mark.parametrize('name', NAMES)
def test_no_lesson_contains_the_names_of_the_robots_nodes(name):
    lessons = [*ROOT.glob('notebooks/**/[0-9]*/[0-9]*.ipynb')]  # no checkpoints of JupyterLab
    assert {path.parents[1].name for path in lessons} == {'notebooks', 'zh_CN'}
    for path in lessons:
        assert name not in path.read_text(encoding='utf-8'), path.name


def test_no_table_of_the_robots_nodes_can_be_imported():
    assert not [each for each in vars(unknown_robot).values() if NAMES[0] in repr(each)]
