"""The joints of a message by name, and the advice for a pose that is not the right one."""

import pytest
from my_robot_basics.checks import joints
from sensor_msgs.msg import JointState

RIGHT = {'joint1': 0.5236, 'joint2': -1.5708}
NAMES = ['joint1', 'joint2']


def message(*position, name=NAMES):
    return JointState(name=name, position=position)


def test_joints_agree_in_any_order():
    assert joints.agree(joints.pose(message(0.52360, -1.57080)), RIGHT)
    assert joints.agree(joints.pose(message(-1.5708, 0.5236, name=NAMES[::-1])), RIGHT)


@pytest.mark.parametrize(
    ('wrong', 'seen', 'advice'),
    [
        (message(0.52004, -1.57), {'joint1': 0.52, 'joint2': -1.57}, 'close: '),
        (message(-1.5708, 0.5236), {'joint1': -1.5708, 'joint2': 0.5236}, 'put x beside'),
        (message(30.0, -90.0), {'joint1': 30.0, 'joint2': -90.0}, 'convert both'),
        (message(0.5236, -1.5708, 0.0), '3 positions with 2 names', 'give each message two'),
        (message(0.5236, name=NAMES[:1]), {'joint1': 0.5236}, 'give each message two'),
        (message(name=[]), '0 positions with 0 names', 'give each message two'),
    ],
)
def test_another_pose_is_shown_with_advice(wrong, seen, advice):
    pose = joints.pose(wrong)
    assert not joints.agree(pose, RIGHT)
    assert joints.shown(wrong) == seen
    assert joints.what_to_try(pose, RIGHT).startswith(advice)
