"""The environment of a lesson."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from geometry_msgs.msg import Point
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from nodes.running import running
from rclpy.duration import Duration

ENTER = """
import json, os
from my_robot_basics.session import classroom
before = set(os.environ)
domain_id = classroom.enter()
assert classroom.enter() == domain_id
print(json.dumps({'domain_id': domain_id, **os.environ}))
"""


def enter(**environment):
    env = {
        k: v for k, v in os.environ.items() if not k.startswith(('ROS_', 'MY_ROBOT', 'RCUTILS'))
    }
    env.pop('FASTRTPS_DEFAULT_PROFILES_FILE', None)
    return subprocess.run(
        [sys.executable, '-c', ENTER], env=env | environment, capture_output=True, text=True
    )


def seen(**environment):
    return json.loads(enter(**environment).stdout)


def test_enter_sets_the_environment_that_a_lesson_needs():
    env = seen(AMENT_PREFIX_PATH='/opt/ros')
    assert 1 <= env['domain_id'] <= 101
    assert env['ROS_DOMAIN_ID'] == str(env['domain_id'])
    assert env['ROS_AUTOMATIC_DISCOVERY_RANGE'] == 'LOCALHOST'
    assert env['RCUTILS_LOGGING_USE_STDOUT'] == '1'
    assert env['RCUTILS_COLORIZED_OUTPUT'] == env['PYTHON_COLORS'] == '0'
    assert env['AMENT_PREFIX_PATH'] == f'{sys.prefix}:/opt/ros'
    assert Path(env['FASTRTPS_DEFAULT_PROFILES_FILE']).is_file()


def test_a_traceback_reads_the_same_on_each_python():
    traceback = 'import os, subprocess, sys; subprocess.run([sys.executable, "-c", "1/0"])'
    program = f'from my_robot_basics.session import classroom; classroom.enter(); {traceback}'
    env = os.environ | {'FORCE_COLOR': '1'}
    run = subprocess.run([sys.executable, '-c', program], env=env, capture_output=True, text=True)
    assert run.stderr.splitlines()[-1] == 'ZeroDivisionError: division by zero'


def test_a_prefix_that_is_already_in_the_path_keeps_its_position():
    path = f'/opt/ros:{sys.prefix}'
    assert seen(AMENT_PREFIX_PATH=path)['AMENT_PREFIX_PATH'] == path


@pytest.mark.parametrize(
    ('given', 'becomes'),
    [
        ({'ROS_DOMAIN_ID': '0'}, None),  # a shell's domain is not the lesson's
        ({'MY_ROBOT_BASICS_DOMAIN_ID': '230'}, 230),
        ({'MY_ROBOT_BASICS_DOMAIN_ID': '0'}, 0),
    ],
)
def test_the_domain_is_claimed_unless_it_is_given(given, becomes):
    domain_id = seen(**given)['domain_id']
    assert domain_id == becomes if becomes is not None else domain_id >= 1


@pytest.mark.parametrize('given', ['233', '-1', 'seven', '٣'])
def test_a_bad_domain_is_refused(given):
    result = enter(MY_ROBOT_BASICS_DOMAIN_ID=given)
    assert result.returncode == 1
    assert 'expected a number from 0 to 232' in result.stderr


@pytest.mark.parametrize(('room', 'expected'), [('test', 'SUBNET'), ('', 'LOCALHOST')])
def test_only_a_grading_room_keeps_its_discovery_range(room, expected):
    given = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'SUBNET'}
    if room:
        given['MY_ROBOT_BASICS_ROOM'] = room
    assert seen(**given)['ROS_AUTOMATIC_DISCOVERY_RANGE'] == expected


@pytest.mark.starts
def test_a_publisher_receives_acknowledgements_within_a_second():
    """Without our request, DDS asks only after 3 s, and each message of a check took that long."""
    classroom.enter()
    with running('ik_client'), Watcher() as watcher:
        publisher = watcher.node.create_publisher(Point, '/target_point', 10)
        assert watcher.spin_until(lambda: publisher.get_subscription_count() > 0, timeout_sec=20.0)
        for _ in range(3):
            publisher.publish(Point())
            assert publisher.wait_for_all_acked(Duration(seconds=1))


def test_a_subscription_receives_from_a_publisher_of_its_process_that_has_sent_many_messages():
    with Watcher() as first, Watcher() as second:
        publisher = first.node.create_publisher(Point, '/target_point', 10)
        for _ in range(5_100):  # more than Fast DDS's default for max_samples
            publisher.publish(Point())
        received = []
        second.node.create_subscription(Point, '/target_point', received.append, 10)
        assert second.spin_until(publisher.get_subscription_count, timeout_sec=10)
        assert second.spin_until(
            lambda: second.node.count_publishers('/target_point'), timeout_sec=10
        )
        second.spin_for(0.3)  # until both know all about each other
        publisher.publish(Point(x=1.0))
        assert second.spin_until(lambda: bool(received), timeout_sec=10)
        assert received == [Point(x=1.0)]
