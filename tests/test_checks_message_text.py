"""How the feedback shows a message that arrived."""

from geometry_msgs.msg import Point
from my_robot_basics.checks.values.message_text import message_text
from sensor_msgs.msg import JointState


def test_joint_states_are_shown_with_joints_in_order():
    message = JointState(name=['joint2', 'joint1'], position=[1.15051, -1.29221])
    assert message_text(message) == "{'joint2': 1.1505, 'joint1': -1.2922}"


def test_joint_states_without_names_are_shown_as_counts():
    assert message_text(JointState(position=[1.0, 2.0])) == '2 positions with 0 names'


def test_other_messages_are_shown_in_full():
    assert message_text(Point(x=1.0)) == 'geometry_msgs.msg.Point(x=1.0, y=0.0, z=0.0)'
