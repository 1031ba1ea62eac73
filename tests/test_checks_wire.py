"""The codec returns plain values unchanged, and refuses hostile ones."""

import base64
import contextlib
import enum
import functools
import json
import math
import re
from collections import ChainMap, UserDict, UserList, deque
from types import MappingProxyType

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from hypothesis import given, settings
from hypothesis import strategies as st
from IPython.utils.text import SList
from my_robot_basics.exchange import values, wire
from my_robot_basics.exchange.wrong_fields import wrong_field
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

scalars = st.none() | st.booleans() | st.integers() | st.floats() | st.text()
keys = scalars | st.tuples(st.integers(), st.text())
plain = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner) | st.lists(inner).map(tuple) | st.sets(keys) | st.dictionaries(keys, inner)
    ),
    max_leaves=20,
)


def same(a, b):
    """Equal in value and in type; a NaN is like a NaN; 1 and True are not alike."""
    return repr(a) == repr(b)


@given(plain)
def test_plain_values_come_back_with_their_types(value):
    encoded = wire.loads(wire.dumps({'ok': values.encode(value)}))['ok']
    back = values.decode(encoded)
    if isinstance(value, set):
        assert sorted(map(repr, back)) == sorted(map(repr, value))
    else:
        assert type(back) is type(value)
    if not _holds_a_set(value):
        assert same(back, value)


def _holds_a_set(value):
    if isinstance(value, dict):
        return any(_holds_a_set(item) for item in value.values())
    return isinstance(value, set) or (
        isinstance(value, list | tuple) and any(map(_holds_a_set, value))
    )


class Gear(enum.IntEnum):
    FIRST = 1


@pytest.mark.parametrize(
    ('value', 'expected'),
    [
        (np.bool_(True), True),
        (np.float64(0.5), 0.5),
        (np.float32(0.5), 0.5),
        (np.int64(3), 3),
        (np.str_('a'), 'a'),
        (np.array([[1, 2], [3, 4]]), [[1, 2], [3, 4]]),
        (np.array([True, False]), [True, False]),
        (np.array(1.5), 1.5),
        (frozenset({1}), {1}),
        ({'a': 1}.keys(), {'a'}),
        ({'a': 1}.values(), [1]),
        (Gear.FIRST, 1),
        (SList(['a', 'b']), ['a', 'b']),
        (deque([1, 2]), [1, 2]),
        (UserList([1, 2]), [1, 2]),
        (UserDict(a=1), {'a': 1}),
        (ChainMap({'a': 1}, {'b': 2}), {'b': 2, 'a': 1}),
        (MappingProxyType({'a': True}), {'a': True}),
        (np.array([math.nan, 1.0]), [math.nan, 1.0]),
    ],
)
def test_values_similar_to_plain_ones_are_sent_as_plain_ones(value, expected):
    assert same(values.decode(json.loads(wire.dumps(values.encode(value)))), expected)


@pytest.mark.parametrize(
    'value',
    [
        object(),
        lambda: None,
        1j,
        b'bytes',
        iter([]),
        np.array([object()]),
        type('Point', (), {})(),
    ],
)
def test_other_values_are_refused(value):
    with pytest.raises(values.UnsupportedValue):
        values.encode(value)


def test_a_list_that_holds_itself_is_too_deep():
    endless = []
    endless.append(endless)
    with pytest.raises(values.UnsupportedValue, match='deep'):
        values.encode(endless)


def joint_state(**fields):
    message = JointState(name=['joint1', 'joint2'], position=[0.5, -0.25], **fields)
    message.header = Header(stamp=Time(sec=7, nanosec=5), frame_id='base_link')
    return message


def test_messages_come_back_equal():
    sent = [joint_state(), Time(sec=1), {'pose': joint_state(effort=[1.0])}]
    assert values.decode(json.loads(wire.dumps(values.encode(sent)))) == sent


WRONG = {
    'header.frame_id = None is no string': {'header.frame_id': None},
    'header.stamp = 12.5 is no builtin_interfaces/Time': {'header.stamp': 12.5},
    'header.stamp.sec = 1.5 is no int32': {'header.stamp.sec': 1.5},
    'header = builtin_interfaces.msg.Time(sec=5, nanosec=0) is no std_msgs/Header': {
        'header': Time(sec=5)
    },
    "name = ['joint1', 2] is no sequence<string>": {'name': ['joint1', 2]},
    'header = builtin_interfaces.msg.Time(sec=1.5, nanosec=0) is no std_msgs/Header': {
        'header': Time(),
        'header.sec': 1.5,
    },
    'name = [1, 1, 1, 1, 1, 1, …] is no sequence<string>': {'name': [1] * 9_000},
    'name = <generator object <genexpr>> is no sequence<string>': {
        'name': (name for name in ['joint1'])
    },
}


@pytest.mark.parametrize(('says', 'fields'), WRONG.items())
def test_a_message_with_a_wrong_field_is_refused_and_the_field_named(says, fields):
    broken = joint_state()
    for path, value in fields.items():
        *parents, last = path.split('.')
        setattr(functools.reduce(getattr, parents, broken), last, value)
    wanted = f'sensor_msgs/msg/JointState with a field of a wrong type ({says})'
    with pytest.raises(values.UnsupportedValue, match=re.escape(wanted)):
        values.encode(broken)


def test_a_wrong_field_of_one_message_in_a_list_is_named():
    results = [SetParametersResult(), SetParametersResult(reason=5)]
    wanted = 'results[1].reason', '5', 'string'
    assert wrong_field(SetParameters.Response(results=results), SetParameters.Response) == wanted


def test_the_error_of_python_is_quoted_if_no_single_field_is_wrong(monkeypatch):
    monkeypatch.setattr(values, 'wrong_field', lambda message, type_: ('', '', ''))
    broken = joint_state()
    broken.name = 5
    with pytest.raises(values.UnsupportedValue, match=r'with a field of a wrong type \(\w+'):
        values.encode(broken)


def test_a_message_of_a_derived_class_is_sent_as_its_base_class():
    class ArmState(JointState):
        def __init__(self, frame_id):
            super().__init__(name=['joint1'])
            self.header.frame_id = frame_id

    arrived = values.decode(values.encode(ArmState('base_link')))
    wanted = JointState(name=['joint1'], header=Header(frame_id='base_link'))
    assert (type(arrived), arrived) == (JointState, wanted)
    with pytest.raises(values.UnsupportedValue, match=r'frame_id = 5 is no string'):
        values.encode(ArmState(5))


def test_a_set_in_a_message_is_refused():
    message = JointState(name=dict.fromkeys(['joint2', 'joint1']).keys())
    assert values.decode(values.encode(message)).name == ['joint2', 'joint1']
    message.name = {'joint1', 'joint2'}
    with pytest.raises(values.UnsupportedValue, match='name is a set: no order'):
        values.encode(message)


CDR = base64.b64encode(serialize_message(joint_state())).decode()
HOSTILE = {
    'not text': 5,
    'nothing': '',
    'not json': '{',
    'deep': '[' * 60_000,
    'deep object': '{"ok":' * 9_000 + '1' + '}' * 9_000,
    'nested': '{"ok":' + '[' * 40 + ']' * 40 + '}',
    'huge': '{"ok":"' + 'a' * 70_000 + '"}',
    'huge integer': '{"ok":' + '9' * 60_000 + '}',
    'bare NaN': '{"ok":NaN}',
    'bare Infinity': '{"ok":-Infinity}',
    'float out of range': '{"ok":1e999}',
    'not an object': '[1]',
    'two answers': '{"ok":1,"missing":"a"}',
    'no answer': '{}',
    'unknown answer': '{"passed":true}',
    'wrong body': '{"missing":1}',
    'exception without text': '{"raised":{"type":"E"}}',
    'exception of numbers': '{"raised":{"type":1,"message":2}}',
    'unknown tag': '{"ok":{"pickle":"gASVAAAA"}}',
    'two tags': '{"ok":{"tuple":[],"set":[]}}',
    'odd float': '{"ok":{"float":"1.0"}}',
    'list in a set': '{"ok":{"set":[[1]]}}',
    'list as a key': '{"ok":{"dict":[[[1],2]]}}',
    'half a pair': '{"ok":{"dict":[[1]]}}',
    'other package': json.dumps({'ok': {'ros': 'os/msg/System', 'cdr': CDR}}),
    'rcl_interfaces': json.dumps({'ok': {'ros': 'rcl_interfaces/msg/Log', 'cdr': CDR}}),
    'path tricks': json.dumps({'ok': {'ros': 'std_msgs/msg/../String', 'cdr': CDR}}),
    'no such message': json.dumps({'ok': {'ros': 'std_msgs/msg/Nothing', 'cdr': CDR}}),
    'not base64': json.dumps({'ok': {'ros': 'sensor_msgs/msg/JointState', 'cdr': '!!'}}),
    'no bytes': json.dumps({'ok': {'ros': 'sensor_msgs/msg/JointState', 'cdr': ''}}),
    'cut short': json.dumps({'ok': {'ros': 'sensor_msgs/msg/JointState', 'cdr': CDR[:40]}}),
}


@pytest.mark.parametrize('text', HOSTILE.values(), ids=HOSTILE)
def test_hostile_replies_raise_wire_error(text):
    with pytest.raises(values.WireError):
        wire.parse_reply(text)


@settings(max_examples=300)
@given(st.binary(max_size=200), st.sampled_from(['cut', 'flip', 'only']), st.integers(0, 2**16))
def test_corrupt_cdr_is_read_as_a_message_or_refused(noise, how, seed):
    whole = serialize_message(joint_state())
    at = seed % len(whole)
    cdr = {'cut': whole[:at], 'flip': whole[:at] + noise + whole[at + len(noise) :], 'only': noise}
    body = {'ros': 'sensor_msgs/msg/JointState', 'cdr': base64.b64encode(cdr[how]).decode()}
    with contextlib.suppress(values.WireError):
        assert isinstance(values.decode(body), JointState)


def test_corrupt_bytes_are_refused_without_output_of_the_c_library(capfd):
    whole = bytearray(serialize_message(joint_state()))
    whole[28:32] = b'\xff\xff\xff\x7f'
    cdr = base64.b64encode(bytes(whole)).decode()
    with pytest.raises(values.WireError, match='bytes that are not a sensor_msgs/msg/JointState'):
        values.decode({'ros': 'sensor_msgs/msg/JointState', 'cdr': cdr})
    assert capfd.readouterr() == ('', '')


json_values = st.recursive(
    scalars, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=30
)


@pytest.mark.starts
@given(json_values | st.dictionaries(st.sampled_from(['ok', 'raised', 'missing']), json_values))
def test_any_json_is_parsed_or_refused(value):
    try:
        kind, _ = wire.parse_reply(json.dumps(value))
    except values.WireError:
        return
    assert kind in ('ok', 'raised', 'missing', 'unsupported', 'failed')
