"""Values that a user types for a message: which are accepted, and how a mistake is reported."""

import contextlib
import math

import pytest
import yaml
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Point, PointStamped, PoseWithCovariance
from hypothesis import given
from hypothesis import strategies as st
from my_robot_basics.ros2 import interfaces
from my_robot_basics.ros2.as_text import Shortening, as_yaml
from my_robot_basics.ros2.fill import BadValue, fill, fill_to_publish
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import JointState, Joy
from std_msgs.msg import Bool, Byte, Char, Empty, Float32, Float64, Int8, Int32, String, UInt64


@pytest.mark.parametrize(
    ('message', 'values', 'expected'),
    [
        (Point(), {'x': 1, 'y': 0.5}, Point(x=1.0, y=0.5)),
        (Float64(), {'data': '1e-3'}, Float64(data=0.001)),  # text in YAML
        (Float64(), {'data': math.inf}, Float64(data=math.inf)),
        (Float32(), {'data': 3.4e38}, Float32(data=3.4e38)),
        (Int32(), {'data': '5'}, Int32(data=5)),
        (Int32(), {'data': 5.0}, Int32(data=5)),
        (UInt64(), {'data': 2**64 - 1}, UInt64(data=2**64 - 1)),
        (Bool(), {'data': 1}, Bool(data=True)),
        (Byte(), {'data': 7}, Byte(data=b'\x07')),
        (Char(), {'data': 255}, Char(data=255)),
        (String(), {'data': 5}, String(data='5')),
        (Empty(), {}, Empty()),
        (Joy(), {'axes': [1], 'buttons': [2]}, Joy(axes=[1.0], buttons=[2])),
        (
            JointState(),
            {'header': {'stamp': {'sec': 3}}, 'name': ['a'], 'position': [1]},
            JointState(name=['a'], position=[1.0]),
        ),
    ],
)
def test_fitting_values_fill_a_message(message, values, expected):
    if 'header' in values:
        expected.header.stamp.sec = 3
    assert fill_to_publish(message, values) == []
    assert message == expected
    assert repr(message) == repr(expected)
    serialize_message(message)


@pytest.mark.parametrize(
    ('message', 'values', 'complaint'),
    [
        (JointState(), {'positon': [1]},
         "positon: sensor_msgs/msg/JointState has no field 'positon': did you mean position?"),
        (Point(), {'theta': 1}, "theta: geometry_msgs/msg/Point has no field 'theta', it has "
         'x, y, z'),
        (Point(), {1: 1}, "1: geometry_msgs/msg/Point has no field '1', it has x, y, z"),
        (Empty(), {'data': 1}, 'data: std_msgs/msg/Empty has no fields'),
        (PointStamped(), {'point': {'x': 'far'}}, "point.x: wants a number (double), got 'far'"),
        (PointStamped(), {'point': [1]}, 'point: wants the fields of geometry_msgs/msg/Point '
         'as a dictionary, got [1]'),
        (PointStamped(), {'header': {'stamp': 'now '}}, 'header.stamp: wants the fields of '
         "builtin_interfaces/msg/Time as a dictionary, got 'now '"),
        (JointState(), {'position': 1}, 'position: wants a list of double, got 1'),
        (JointState(), {'position': [0, [1]]}, 'position[1]: wants a number (double), got [1]'),
        (JointState(), {'name': 'joint1'}, "name: wants a list of string, got 'joint1'"),
        (JointState(), {'name': [None]}, 'name[0]: wants a string, got None'),
        (PoseWithCovariance(), {'covariance': [1.0]},
         'covariance: wants a list of double of length 36, got 1'),
        (DiagnosticArray(), {'status': [{}, {'level': 'bad'}]},
         "status[1].level: wants a whole number (octet), got 'bad'"),
        (Float64(), {'data': True}, 'data: wants a number (double), got True'),
        (Float64(), {'data': None}, 'data: wants a number (double), got None'),
        (Float64(), {'data': 10**400}, f'data: wants a number (double), got {10**400}'),
        (Float32(), {'data': 1e39}, 'data: 1e+39 does not fit a 32-bit float'),
        (Int8(), {'data': 128}, 'data: wants int8, -128 to 127, got 128'),
        (Int32(), {'data': 1.5}, 'data: wants a whole number (int32), got 1.5'),
        (Int32(), {'data': math.nan}, 'data: wants a whole number (int32), got nan'),
        (UInt64(), {'data': -1}, f'data: wants uint64, 0 to {2**64 - 1}, got -1'),
        (Byte(), {'data': 256}, 'data: wants octet, 0 to 255, got 256'),
        (Bool(), {'data': 'false'}, "data: wants true or false, got 'false'"),
        (Bool(), {'data': 2}, 'data: wants true or false, got 2'),
        (String(), {'data': {'a': 1}}, "data: wants a string, got {'a': 1}"),
        (String(), {'data': '\0'}, "data: a string holds no zero character, got '\\x00'"),
        (String(), {'data': '\ud800'}, "data: is not text in UTF-8: '\\ud800'"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_reported_with_its_path_and_the_expected_type(message, values, complaint):
    with pytest.raises(BadValue) as raised:
        fill(message, values)
    assert str(raised.value) == complaint


def test_stamps_are_set_at_publication():
    stamped, status = PointStamped(), DiagnosticArray()
    setters = fill_to_publish(stamped, {'header': {'stamp': 'now', 'frame_id': 'a'}})
    setters += fill_to_publish(status, {'header': 'auto'})
    for set_stamp in setters:
        set_stamp(Time(sec=7))
    assert (stamped.header.stamp.sec, stamped.header.frame_id) == (7, 'a')
    assert status.header.stamp.sec == 7


@pytest.mark.parametrize('value', ['now', 'auto'])
def test_a_request_accepts_neither_now_nor_auto_for_a_stamp(value):
    field = {'now': {'stamp': 'now'}, 'auto': 'auto'}[value]
    with pytest.raises(BadValue, match=rf"as a dictionary, got '{value}'"):
        fill(PointStamped(), {'header': field})


MESSAGES = [interfaces.message_class(name) for name in interfaces.names('msg')]
SCALARS = (
    st.none() | st.booleans() | st.integers(-(2**65), 2**65) | st.floats() | st.text(max_size=3)
)
VALUES = st.recursive(
    SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner)
)


@st.composite
def guesses(draw):
    message_class = draw(st.sampled_from(MESSAGES))
    names = [*message_class.get_fields_and_field_types()]
    return message_class, draw(st.dictionaries(st.sampled_from([*names, 'no']), VALUES))


def sent(message):
    """Return a message as it arrives."""
    return deserialize_message(serialize_message(message), type(message))


def text(message):
    return as_yaml(message, Shortening())


@given(guesses())
def test_any_typed_values_either_fit_a_message_or_are_refused(guess):
    message_class, values = guess
    message = message_class()
    with contextlib.suppress(BadValue):
        fill(message, values)
        arrived = sent(message)  # rclpy does not check, and dies of some values
        assert text(sent(arrived)) == text(arrived)


# a byte is echoed as a character, as in ros2cli, and typed as a number
ECHOED = [found for found in MESSAGES if found not in (Byte, DiagnosticStatus)]


@pytest.mark.parametrize('message_class', ECHOED, ids=lambda c: f'{c.__module__}.{c.__name__}')
def test_an_echoed_message_can_be_published_again(message_class):
    message = message_class()
    fill(message, yaml.safe_load(text(message_class())))
    assert text(sent(message)) == text(message_class())
