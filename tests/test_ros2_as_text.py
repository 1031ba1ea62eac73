"""Messages as `ros2 topic echo` prints them."""

import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import PoseWithCovariance
from my_robot_basics.ros2.as_text import Shortening, as_csv, as_yaml
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Byte, ByteMultiArray, Empty, Float64, Header, String

STAMPED = JointState(
    header=Header(stamp=Time(sec=3, nanosec=5), frame_id='base_link'),
    name=['joint1', 'joint2'],
    position=[0.5, float('nan')],
)
JOINT_STATE = """\
header:
  stamp:
    sec: 3
    nanosec: 5
  frame_id: base_link
name:
- joint1
- joint2
position:
- 0.5
- .nan
velocity: []
effort: []
"""
FLOW = """\
header:
  stamp:
    sec: 3
    nanosec: 5
  frame_id: base_link
name: [joint1, joint2]
position: [0.5, .nan]
velocity: []
effort: []
"""
WITHOUT_ARRAYS = """\
header:
  stamp:
    sec: 3
    nanosec: 5
  frame_id: base_link
name: '<sequence type: string, length: 2>'
position: '<sequence type: double, length: 2>'
velocity: '<sequence type: double, length: 0>'
effort: '<sequence type: double, length: 0>'
"""
STATUS = DiagnosticStatus(level=b'\x02', name='é', values=[KeyValue(key='k', value='v')])
POSE = PoseWithCovariance()


@pytest.mark.parametrize(
    ('message', 'shortening', 'expected'),
    [
        (STAMPED, {}, JOINT_STATE),
        (STAMPED, {'no_arr': True}, WITHOUT_ARRAYS),
        (STAMPED, {'length': 2}, JOINT_STATE.replace('base_link', 'ba...').replace(
            'joint1', 'jo...').replace('joint2', 'jo...')),
        (STAMPED.header, {'no_str': True},
         "stamp:\n  sec: 3\n  nanosec: 5\nframe_id: '<string length: <9>>'\n"),
        (JointState(name=['a', 'b', 'c']).header, {}, "stamp:\n  sec: 0\n  nanosec: 0\n"
         "frame_id: ''\n"),
        (String(data='Hello World'), {'length': 5}, 'data: Hello...\n'),
        (String(data='a: b'), {}, "data: 'a: b'\n"),
        (String(data='é' * 200), {}, f'data: {"é" * 200}\n'),
        (Bool(data=True), {}, 'data: true\n'),
        (Byte(data=b'\x07'), {}, 'data: "\\a"\n'),
        (Float64(data=float('-inf')), {}, 'data: -.inf\n'),
        (Empty(), {}, '{}\n'),
        (STATUS, {}, 'level: "\\x02"\nname: é\nmessage: \'\'\nhardware_id: \'\'\nvalues:\n'
         '- key: k\n  value: v\n'),
        (STATUS, {'length': 0}, "level: '...'\nname: '...'\nmessage: ''\nhardware_id: ''\n"
         "values:\n- '...'\n"),
        (STATUS, {'no_arr': True}, 'level: "\\x02"\nname: é\nmessage: \'\'\nhardware_id: \'\'\n'
         "values: '<sequence type: diagnostic_msgs/msg/KeyValue, length: 1>'\n"),
        (POSE, {'no_arr': True}, 'pose:\n  position:\n    x: 0.0\n    y: 0.0\n    z: 0.0\n'
         '  orientation:\n    x: 0.0\n    y: 0.0\n    z: 0.0\n    w: 1.0\n'
         "covariance: '<array type: double[36]>'\n"),
    ],
)  # fmt: skip
def test_a_message_is_printed_as_yaml(message, shortening, expected):
    assert as_yaml(message, Shortening(**shortening)) == expected


def test_yaml_in_flow_style_has_arrays_on_one_line():
    assert as_yaml(STAMPED, Shortening(), flow_style=True) == FLOW
    values = as_yaml(STATUS, Shortening(), flow_style=True).partition('values: ')[2]
    assert values == '[{key: k, value: v}]\n'
    assert as_yaml(Empty(), Shortening(), flow_style=True) == '{}\n'


@pytest.mark.parametrize(
    ('message', 'shortening', 'expected'),
    [
        (STAMPED, {}, '3,5,base_link,joint1,joint2,0.5,nan,,'),
        (STAMPED, {'length': 1}, '3,5,b...,j...,...,0.5,...,,'),
        (STAMPED, {'no_arr': True}, '3,5,base_link,<sequence type: string, length: 2>,'
         '<sequence type: double, length: 2>,<sequence type: double, length: 0>,'
         '<sequence type: double, length: 0>'),
        (STAMPED.header, {'no_str': True}, '3,5,<string length: <9>>'),
        (STATUS, {}, "b'\\x02',é,,,k,v"),
        (KeyValue(value='v'), {}, 'v'),
        (ByteMultiArray(data=[b'a']), {}, "0,b'a'"),
        (Bool(data=True), {}, 'True'),
        (Empty(), {}, ''),
    ],
)  # fmt: skip
def test_a_message_is_printed_as_csv(message, shortening, expected):
    assert as_csv(message, Shortening(**shortening)) == expected
