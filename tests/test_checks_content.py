"""Equal messages compare as equal, with any bytes in memory before."""

import random

import pytest
from geometry_msgs.msg import Point, Point32, PoseWithCovariance
from my_robot_basics.checks.values.content import content
from rclpy.serialization import serialize_message
from sensor_msgs.msg import ChannelFloat32, JointState, PointCloud


def bare():
    """A message with two empty sequences of doubles after four bytes that no field fills."""
    message = JointState(name=['joint1', 'joint2'], position=[0.5, -1.2])
    message.header.frame_id = 'base_link'
    return message


def any_other(numbers):
    message = JointState(name=['x' * numbers.randrange(9)])
    message.position = [numbers.random() for _ in range(numbers.randrange(9))]
    message.velocity = [numbers.random() for _ in range(numbers.randrange(9))]
    message.header.frame_id = 's' * numbers.randrange(20)
    return message


def different(value_of):
    """How many values equal messages have, if others are serialized in between."""
    numbers, values = random.Random(1), set()
    for _ in range(2000):
        serialize_message(any_other(numbers))
        values.add(value_of(bare()))
    return len(values)


def test_equal_messages_have_one_content_though_their_bytes_differ():
    assert different(content) == 1
    assert different(serialize_message) > 1


@pytest.mark.parametrize(
    'other',
    [
        JointState(name=['joint1'], position=[0.5]),
        JointState(name=['joint1'], position=[-0.0]),
        JointState(name=['joint1'], position=[float('nan')]),
        JointState(name=['joint'], position=[0.0]),
        JointState(name=['joint1'], velocity=[0.0]),
    ],
    ids=['number', 'sign', 'nan', 'name', 'field'],
)
def test_a_different_number_sign_name_or_field_changes_the_content(other):
    assert content(other) != content(JointState(name=['joint1'], position=[0.0]))
    assert content(other) == content(other)


def test_a_single_number_is_compared_like_a_sequence():
    assert content(Point(x=-0.0)) != content(Point(x=0.0))
    assert content(Point(x=float('nan'))) == content(Point(x=float('nan')))


def test_a_message_that_is_sent_has_the_content_that_is_received():
    sent = PointCloud(channels=[ChannelFloat32(name='intensity', values=[0.1])])
    sent.points = [Point32(x=0.1)]
    rounded = PointCloud(channels=[ChannelFloat32(name='intensity', values=[0.1])])
    rounded.points = [Point32(x=0.10000000149011612)]
    assert content(sent) == content(rounded)


def test_a_fixed_size_array_is_part_of_the_content():
    one, other = PoseWithCovariance(), PoseWithCovariance()
    other.covariance[35] = 1.0
    assert content(one) != content(other)
