"""What the shell offers after Tab."""

import os
import subprocess

import pexpect
import pytest
from ros2_command import SCRIPT, TIMEOUT_SEC, on_the_graph, own_domain, ros2


@pytest.fixture(scope='module')
def system():
    topics = ('/everything_is_up', '/kinematics/joint_states')
    with own_domain(), on_the_graph('everything', 'five_hz', topics=topics):
        yield


COMPLETIONS = [
    ('ros2 to', ['topic']),
    ('ros2 topic i', ['info']),
    ('ros2 topic echo --qos-rel', ['--qos-reliability']),
    ('ros2 topic echo --qos-reliability b', ['best_available', 'best_effort']),
    ('ros2 topic info /k', ['/kinematics/joint_states']),
    ('ros2 topic pub /kinematics/joint_states s', ['sensor_msgs/msg/JointState']),
    ('ros2 topic pub /new geometry_msgs/msg/PoseS', ['geometry_msgs/msg/PoseStamped']),
    ('ros2 topic find sensor_msgs/msg/Jo', ['sensor_msgs/msg/JointState', 'sensor_msgs/msg/Joy',
     'sensor_msgs/msg/JoyFeedback', 'sensor_msgs/msg/JoyFeedbackArray']),
    ('ros2 interface show std_srvs/', ['std_srvs/srv/Empty', 'std_srvs/srv/SetBool',
     'std_srvs/srv/Trigger']),
    ('ros2 node info /', ['/arm/everything', '/kinematics_publisher']),
    ('ros2 param d', ['delete', 'describe', 'dump']),
    ('ros2 param get /arm/everything a_', ['a_bool', 'a_double', 'a_string']),
    ('ros2 param delete /arm/everything a_', ['a_bool', 'a_double', 'a_string']),
    ('ros2 param describe /arm/everything an_integer a_', ['a_bool', 'a_double', 'a_string']),
    ('ros2 param dump /a', ['/arm/everything']),
    ('ros2 param load /a', ['/arm/everything']),
    ('ros2 service type /arm/s', ['/arm/start']),
    ('ros2 service info /arm/s', ['/arm/start']),
    ('ros2 service call /arm/s', ['/arm/start']),
    ('ros2 service call /arm/start s', ['std_srvs/srv/Trigger']),
    ('ros2 service call /new std_srvs/srv/S', ['std_srvs/srv/SetBool']),
    ('ros2 service call /new std_srvs/srv/SetBool d', ['data:\\ false\\']),
    ('ros2 service find std_srvs/srv/T', ['std_srvs/srv/Trigger']),
    ('ros2 action info /arm/m', ['/arm/move']),
    ('ros2 action type /arm/m', ['/arm/move']),
    ('ros2 action send_goal /arm/m', ['/arm/move']),
    ('ros2 action send_goal /arm/move a', ['arm_interfaces/action/MoveArm']),
    ('ros2 action send_goal /new arm', ['arm_interfaces/action/MoveArm']),
    ('ros2 action send_goal /new arm_interfaces/action/MoveArm p',
     ['position:\\ \\[\\]\\\nspeed:\\ 0.0\\']),
    ('ros2 pkg prefix rclp', ['rclpy']),
]  # fmt: skip


@pytest.mark.usefixtures('system')
@pytest.mark.parametrize(('line', 'expected'), COMPLETIONS, ids=[line for line, _ in COMPLETIONS])
def test_words_of_ros2_command_lines_are_completed(line, expected, tmp_path):
    answer = tmp_path / 'answer'
    asked = {'_ARGCOMPLETE': '1', 'COMP_LINE': line, 'COMP_POINT': str(len(line)), 'IFS': '\v'}
    ros2(**asked, _ARGCOMPLETE_STDOUT_FILENAME=str(answer))
    assert sorted(word.strip() for word in answer.read_text().split('\v')) == expected


@pytest.mark.usefixtures('system')
def test_topic_doctor_completes_topic_names(tmp_path):
    line, answer = 'topic_doctor /kin', tmp_path / 'answer'
    asked = {'_ARGCOMPLETE': '1', 'COMP_LINE': line, 'COMP_POINT': str(len(line)), 'IFS': '\v'}
    subprocess.run(
        [SCRIPT.with_name('topic_doctor')],
        env={**os.environ, **asked, '_ARGCOMPLETE_STDOUT_FILENAME': str(answer)},
        timeout=TIMEOUT_SEC,
    )
    assert answer.read_text().strip() == '/kinematics/joint_states'


@pytest.mark.parametrize('name', ['ros2', 'topic_doctor'])
def test_argcomplete_finds_its_marker_in_the_scripts(name):
    # it reads so much of a script
    assert b'PYTHON_ARGCOMPLETE_OK' in SCRIPT.with_name(name).read_bytes()[:1024]


def test_the_tab_key_completes_in_bash(system):
    register = SCRIPT.with_name('register-python-argcomplete')
    with pexpect.spawn('bash', ['--norc'], encoding='utf-8', timeout=20) as shell:
        shell.sendline(f'PATH="{SCRIPT.parent}:$PATH"; eval "$("{register}" ros2)"; echo re"ady"')
        shell.expect_exact('ready')
        shell.send('ros2 topic info /kin\t')
        shell.expect_exact('/kinematics/joint_states')
