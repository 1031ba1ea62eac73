"""The joints of a message by name, and the advice for a pose that is not the right one."""

import math

import pytest
from geometry_msgs.msg import Point
from my_robot_basics.checks import CheckFailed, joints
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray

POSE_DEG = 30.0, -90.0
RIGHT = joints.in_radians(POSE_DEG)
NAMES = ['joint1', 'joint2']


def message(*position, name=NAMES):
    return JointState(name=name, position=position)


def test_a_float_array_is_no_pose_and_gets_advice():
    wrong = Float64MultiArray(data=[0.5236, -1.5708])
    assert joints.pose(wrong) == {}
    assert joints.shown(wrong) == 'a message of the type Float64MultiArray'
    assert joints.why_wrong(wrong, POSE_DEG, others_right=True) == joints.OTHER_TYPE


@pytest.mark.parametrize(
    ('seen', 'advice'),
    [
        (NAMES * 2, 'it adds to the names of the call before'),
        (['joint1', 'joint1', 'joint3'], 'letter for letter'),
        (['joint_1', 'joint_2'], 'letter for letter'),
        ([], 'ignores arguments of any other name'),
    ],
)
def test_names_that_grow_with_each_call_get_another_advice_than_wrong_ones(seen, advice):
    assert advice in joints.why_names(seen, NAMES)


def test_an_empty_list_of_positions_may_come_from_a_field_of_another_name():
    without = JointState(name=NAMES, positions=[0.5, -1.0])  # rclpy raises nothing
    assert 'ignores arguments of any other name' in joints.why_off(without.position, POSE_DEG)
    assert 'one position for each joint into the list' in joints.why_off([0.5], POSE_DEG)


def test_joints_agree_in_any_order():
    assert joints.agree(joints.pose(message(0.52360, -1.57080)), RIGHT)
    assert joints.agree(joints.pose(message(-1.5708, 0.5236, name=NAMES[::-1])), RIGHT)


def test_a_good_approximation_agrees_for_every_angle_and_a_rough_one_not_for_the_open_ones():
    def agrees(convert, *pose_deg):
        return joints.agree(
            joints.pose(message(*map(convert, pose_deg))), joints.in_radians(pose_deg)
        )

    good = {
        'over 57.3': lambda deg: deg / 57.3,
        'times 0.0174533': lambda deg: deg * 0.0174533,
        'four decimals': lambda deg: round(math.radians(deg), 4),
    }
    rough = {
        '3.14': lambda deg: deg * 3.14 / 180,
        'times 0.01745': lambda deg: deg * 0.01745,
        'three decimals': lambda deg: round(math.radians(deg), 3),
    }
    tenths = [tenth / 10 for tenth in range(1801)]
    off = {name: [deg for deg in tenths if not agrees(by, deg, -deg)] for name, by in good.items()}
    assert [(name, found[:3]) for name, found in off.items() if found] == []
    assert [name for name, by in rough.items() if agrees(by, *POSE_DEG)] == []


@pytest.mark.parametrize(
    ('wrong', 'seen', 'advice'),
    [
        (message(0.52004, -1.57), {'joint1': 0.52, 'joint2': -1.57}, 'close: '),
        (
            message(-1.5708, 0.5236),
            {'joint1': -1.5708, 'joint2': 0.5236},
            'the joints are swapped',
        ),
        (message(30.0, -90.0), {'joint1': 30.0, 'joint2': -90.0}, 'these are degrees'),
        (message(0.5236, -90.0), {'joint1': 0.5236, 'joint2': -90.0}, 'joint2 is still in degr'),
        (message(30.0, -1.5708), {'joint1': 30.0, 'joint2': -1.5708}, 'joint1 is still in degr'),
        (message(0.5236, 1.5708), {'joint1': 0.5236, 'joint2': 1.5708}, 'the sign of joint2'),
        (message(0.5236, 0.5236), {'joint1': 0.5236, 'joint2': 0.5236}, 'joint2 holds θ1, too'),
        (
            message(1718.8734, -5156.6202),
            {'joint1': 1718.8734, 'joint2': -5156.6202},
            'degrees() ',
        ),
        (message(0.5, -1.6), {'joint1': 0.5, 'joint2': -1.6}, 'close: '),
        (message(0.5236, -1.0472), {'joint1': 0.5236, 'joint2': -1.0472}, 'joint2 holds θ1 + θ2'),
        (message(0.2618, -0.7854), {'joint1': 0.2618, 'joint2': -0.7854}, '180 degrees are pi'),
        (message(0.0833, -0.25), {'joint1': 0.0833, 'joint2': -0.25}, 'these are parts of a wh'),
        (message(0.1667, -0.5), {'joint1': 0.1667, 'joint2': -0.5}, 'these are parts of half a'),
        (
            message(1.0472, -3.1416),
            {'joint1': 1.0472, 'joint2': -3.1416},
            '180 degrees are pi radians, and not 2',
        ),
        (message(0.5236, 4.7124), {'joint1': 0.5236, 'joint2': 4.7124}, 'it is a whole turn too'),
        (message(0.7, 0.1), {'joint1': 0.7, 'joint2': 0.1}, 'convert both angles with'),
        (message(0.5236, -1.5708, 0.0), '3 positions with 2 names', 'give each message two'),
        (message(0.5236, name=NAMES[:1]), {'joint1': 0.5236}, 'give each message two'),
        (
            message(0.5236, -1.5708, 0.5236, -1.5708, name=NAMES * 2),
            '4 positions with 4 names',
            'it adds to the names of the call before',
        ),
        (
            message(0.1, 0.2, 0.5236, -1.5708),
            '4 positions with 2 names',
            'it adds to the positions',
        ),
        (message(0.0, 0.0, 0.5236, -1.5708), '4 positions with 2 names', 'give each message two'),
        (message(30.0, -90.0, 0.5236, -1.5708), '4 positions with 2 names', 'give each message'),
        (message(0.1, 0.2, 0.3, 0.4), '4 positions with 2 names', 'give each message two'),
        (message(0.1, 0.5236, -1.5708), '3 positions with 2 names', 'give each message two'),
        (message(name=[]), '0 positions with 0 names', 'give each message two'),
    ],
)
def test_a_wrong_pose_is_shown_with_advice(wrong, seen, advice):
    pose = joints.pose(wrong)
    assert not joints.agree(pose, RIGHT)
    assert joints.shown(wrong) == seen
    assert joints.why_wrong(wrong, POSE_DEG).startswith(advice)


def test_advice_to_convert_angles_depends_on_earlier_right_poses():
    seen = message(0.7, 0.1)
    assert joints.why_wrong(seen, POSE_DEG, others_right=True) == joints.CONVERT_EACH
    assert joints.why_wrong(seen, POSE_DEG) == joints.CONVERT


@pytest.mark.parametrize(
    ('position', 'advice'),
    [
        ([0.5236, math.nan], 'not a finite number'),
        ([math.nan, -1.5708], 'not a finite number'),
        ([math.inf, -1.5708], 'not a finite number'),
        ([0.5236], 'one position for each joint'),
        ([0.5236, -1.57], 'do not round'),
    ],
)
def test_missing_rounded_and_non_finite_positions_fail(position, advice):
    with pytest.raises(CheckFailed, match=advice):
        joints.expect_radians(position, POSE_DEG)
    joints.expect_radians([math.radians(angle) for angle in POSE_DEG], POSE_DEG)


def test_a_point_is_no_pose_and_gets_advice():
    point = Point(x=0.5)
    assert joints.pose(point) == {}
    assert joints.shown(point) == 'a message of the type Point'
    assert joints.why_wrong(point, (30.0, 45.0)).startswith('publish a JointState there')
