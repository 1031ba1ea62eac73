"""What the feedback shows of a message that arrived."""

from geometry_msgs.msg import Point
from my_robot_basics.checks.shown import shown
from sensor_msgs.msg import JointState


def test_of_joint_states_the_joints_in_their_order():
    message = JointState(name=['joint2', 'joint1'], position=[1.15051, -1.29221])
    assert shown(message) == "{'joint2': 1.1505, 'joint1': -1.2922}"


def test_of_one_without_names_how_many_positions_it_has():
    assert shown(JointState(position=[1.0, 2.0])) == '2 positions with 0 names'


def test_of_other_messages_all():
    assert shown(Point(x=1.0)) == 'geometry_msgs.msg.Point(x=1.0, y=0.0, z=0.0)'
