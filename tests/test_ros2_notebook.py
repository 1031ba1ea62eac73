"""`!ros2 …` in the cells of a real kernel: it joins the lesson, and ends with the cell."""

import os
import re

import pytest
from jupyter_client.manager import start_new_kernel

SETUP = """
from my_robot_basics.live import run
from my_robot_basics.kinematics_publisher import KinematicsPublisher
publisher = run(KinematicsPublisher)
"""
WAITER = """
from my_robot_basics.live import stop, wait_until
from rclpy.action import ActionServer, CancelResponse
from rclpy.node import Node
from rclpy.task import Future
from arm_interfaces.action import MoveArm

cancelled = []

class Waiter(Node):
    def __init__(self):
        super().__init__('waiter')
        self.asked = Future()
        ActionServer(self, MoveArm, '/wait', self.execute, cancel_callback=self.cancel)

    def cancel(self, handle):
        self.asked.set_result(None)
        return CancelResponse.ACCEPT

    async def execute(self, handle):
        await self.asked
        handle.canceled()
        cancelled.append(True)
        return MoveArm.Result()

waiter = run(Waiter)
"""
TOPIC = '/kinematics/joint_states'


class Lesson:
    def __init__(self):
        env = os.environ | {'PYDEVD_DISABLE_FILE_VALIDATION': '1'}
        env.pop('ROS_DOMAIN_ID')
        self.manager, self.client = start_new_kernel(kernel_name='python3', env=env)

    def run(self, source, *, interrupt_at=None):
        """Return the text of a cell; interrupt the kernel when `interrupt_at` appears in it."""
        text, interrupted = '', False

        def take(message):
            nonlocal text, interrupted
            text += message['content'].get('text', '')
            if interrupt_at and interrupt_at in text and not interrupted:
                interrupted = True
                self.manager.interrupt_kernel()

        self.client.execute_interactive(source, timeout=60, output_hook=take)
        return text.replace('\r\n', '\n')


@pytest.fixture(scope='module')
def lesson():
    lesson = Lesson()
    lesson.run(SETUP)
    yield lesson
    lesson.client.stop_channels()
    lesson.manager.shutdown_kernel()


def test_a_cell_sees_the_nodes_of_its_kernel(lesson):
    assert lesson.run('!ros2 node list') == '/kinematics_publisher\n'
    assert lesson.run(f'!ros2 topic info {TOPIC}') == (
        'Type: sensor_msgs/msg/JointState\nPublisher count: 1\nSubscription count: 0\n'
    )


def test_a_cell_calls_a_service_of_its_kernel(lesson):
    kind = 'rcl_interfaces/srv/ListParameters'
    assert lesson.run(f'!ros2 service find {kind}') == '/kinematics_publisher/list_parameters\n'
    text = lesson.run(f'!ros2 service call /kinematics_publisher/list_parameters {kind}')
    assert "ListParametersResult(names=['" in text
    assert 'Traceback' not in text


def test_topic_hz_in_a_cell_ends_at_sigint_without_a_traceback(lesson):
    text = lesson.run(f'!timeout -s INT 9 ros2 topic hz {TOPIC}')
    assert re.match(r'average rate: (0\.[89]|1\.[01])\d\d\n\tmin: \d', text), text
    assert 'Traceback' not in text


def test_a_pipe_in_a_cell_ends_with_its_reader(lesson):
    text = lesson.run(f'!ros2 topic echo {TOPIC} | head -3')
    assert re.fullmatch(r'header:\n  stamp:\n    sec: \d+\n', text)


def test_an_interrupt_cancels_the_goal_of_a_cell(lesson):
    lesson.run(WAITER)
    goal = '!ros2 action send_goal /wait arm_interfaces/action/MoveArm'
    text = lesson.run(goal, interrupt_at='Goal accepted')
    assert 'Traceback' not in text
    assert lesson.run('wait_until(lambda: cancelled) or print(cancelled)') == '[True]\n'
    assert lesson.run('!ros2 action info /wait') == (
        'Action: /wait\nAction clients: 0\nAction servers: 1\n    /waiter\n'
    )
    lesson.run('stop(Waiter)')


@pytest.mark.parametrize(
    ('command', 'begins'),
    [
        ('ros2 topic hz /nothing', 'does not appear to be published yet'),
        ('ros2 topic pub /x std_msgs/msg/String', 'publishing #1'),
        ('ros2 service call /nothing std_srvs/srv/Empty', 'waiting for service'),
        ('ros2 run my_robot_basics kinematics_subscriber', 'waiting for poses'),
    ],
)
def test_an_interrupt_ends_a_cell_and_leaves_nothing_behind(lesson, command, begins):
    text = lesson.run(f'!{command}', interrupt_at=begins)
    assert begins in text
    assert 'Traceback' not in text
    nodes = lesson.run('!ros2 node list --all')
    # on a busy machine, not all nodes are discovered in time: but there must be no others
    assert re.fullmatch(r'(/_live\n)?/_ros2cli_\d+\n(/kinematics_publisher\n)?', nodes)
