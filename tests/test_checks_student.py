"""Asking for values: the same words in the student's kernel and in the test kernel."""

import json
import re
import subprocess
import sys
import threading
import time
import warnings

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from my_robot_basics.checks import CheckFailed, student
from my_robot_basics.exchange import node_troubles, responder, values, wire
from my_robot_basics.feedback.rclpy_names import OWN_ATTRIBUTES
from my_robot_basics.graph.stop_reasons import what_raised, what_stopped
from my_robot_basics.live.output import overwritten
from my_robot_basics.live.patches import harmless_errors
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState

from my_robot_basics import live

MODES = ['one process', 'test room']


@pytest.fixture(params=MODES)
def notebook(request, monkeypatch):
    """A function that defines names in `__main__`; requests take both ways."""
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    if request.param == 'test room':
        monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
        monkeypatch.setattr('builtins.input', responder.answer)
    return lambda **names: [
        monkeypatch.setattr(sys.modules['__main__'], n, v, raising=False) for n, v in names.items()
    ]


def raising(x):
    raise ValueError('out of\n  reach')


def with_a_stamp_for_a_header(x):
    message = JointState()
    message.header = Time(sec=x)
    return message


def deep_in_itself(x):
    endless = [x]
    endless.append(endless)
    return endless


def exiting(x):
    raise SystemExit(3)


CALLS = {
    'a bool': (lambda x: x > 1, bool, True),
    'a NumPy bool': (lambda x: np.bool_(x > 1), bool, True),
    'a float': (lambda x: x / 4, float, 0.5),
    'an int for a float': (lambda x: x, float, 2),
    'a tuple': (lambda x: (x, 'a'), tuple, (2, 'a')),
    'either of two': (lambda x: {x}, (list, set), {2}),
    'any type': (lambda x: [None], None, [None]),
}


@pytest.mark.parametrize(('function', 'returns', 'expected'), CALLS.values(), ids=CALLS)
def test_call_returns_what_the_function_returned(notebook, function, returns, expected):
    notebook(f=function)
    result = student.call('f', 2, returns=returns)
    assert result == expected
    assert type(result) is type(expected)


FAILURES = {
    'missing': (None, 'a function named `f`, saw no such name: define it as `def f(…):` in'),
    'raises': (raising, 'expected `f(2)` to return, saw ValueError: out of reach: call'),
    'raises what Python tells in its own words': (
        lambda x: 2.0 ^ x,
        "for ^: 'float' and 'int'`, so write ** for a power, such as x**2",
    ),
    'returns in one branch': (lambda x: None, 'end each branch of `f` with `return …` (printin'),
    'exits': (exiting, 'expected `f(2)` to return, saw SystemExit: 3: call'),
    'forgot return': (lambda x: print('!'), 'expected `f(2)` to return a value, saw None: end'),
    'int for a bool': (lambda x: 1, 'a bool, saw an int (1): write True or False, or a c'),
    'text for a bool': (lambda x: 'True', "saw a str ('True'): a text in quotes is always a text"),
    'a generator': (lambda x: iter([]), 'to return a bool, saw a list_iterator: return plain'),
    'a generator within': (lambda x: {'a': iter([])}, 'bool, saw a list_iterator in it'),
    'a complex number of NumPy': (lambda x: np.complex128(1), 'a bool, saw a numpy complex128: '),
    'too deep': (deep_in_itself, 'to return a bool, saw values nested more than'),
    'a wrong field': (with_a_stamp_for_a_header, 'is no std_msgs/Header): give each field a'),
    'exits silently': (lambda x: sys.exit(), 'expected `f(2)` to return, saw SystemExit: call'),
    'not a function': (5, "saw TypeError: 'int' object is not callable"),
    'too much': (lambda x: 'a' * 70_000, 'saw more than 64 kB of text'),
}  # fmt: skip


@pytest.mark.parametrize(('function', 'message'), FAILURES.values(), ids=FAILURES)
def test_call_fails_with_advice_for_the_mistake(notebook, capfd, function, message):
    if function is not None:
        notebook(f=function)
    with pytest.raises(CheckFailed) as failed:
        student.call('f', 2, returns=bool)
    assert message in str(failed.value)
    assert '\n' not in str(failed.value)
    assert capfd.readouterr().err == ''


def test_messages_are_passed_to_and_returned_from_a_function(notebook):
    def to_joint_state(theta1_deg, theta2_deg, stamp):
        message = JointState(name=['joint1', 'joint2'], position=[theta1_deg, theta2_deg])
        message.header.stamp = stamp
        return message

    notebook(to_joint_state=to_joint_state)
    stamp = Time(sec=3, nanosec=4)
    message = student.call('to_joint_state', 1.0, 2.0, stamp, returns=JointState)
    assert (message.header.stamp, list(message.position)) == (stamp, [1.0, 2.0])


def test_value_reads_a_name(notebook):
    notebook(endpoints={'publishers': ['/a', '/b'], 'subscriptions': ('c',)})
    assert student.value('endpoints', type=dict)['subscriptions'] == ('c',)
    with pytest.raises(CheckFailed, match='expected `endpoints` to be a list, saw a dict'):
        student.value('endpoints', type=list)
    notebook(endpoints=dict)
    with pytest.raises(CheckFailed, match='expected `endpoints` to be a dict, saw a class'):
        student.value('endpoints', type=dict)
    with pytest.raises(CheckFailed, match='expected a value for `nothing`, saw no such name'):
        student.value('nothing')


@pytest.mark.parametrize(
    ('wanted', 'advice'),
    [
        (dict, 'write a dict, {key: value, …}, with the keys of the answer cell'),
        (JointState, 'make a message with JointState(), fill in its fields, and return it'),
        (list, 'print(type(…)) of the value shows what it is'),
    ],
)
def test_advice_depends_on_the_expected_type(notebook, wanted, advice):
    notebook(f=lambda: 5)
    with pytest.raises(CheckFailed) as failed:
        student.call('f', returns=wanted)
    assert str(failed.value).endswith(f'saw an int (5): {advice}')


@pytest.mark.parametrize(
    ('result', 'seen'),
    [
        (JointState, 'saw the class JointState: make a message of it with parentheses, Joi'),
        (type('JointState', (), {})(), 'saw another class JointState: make no class JointState'),
        (int, 'saw a class: make a message with JointState()'),
        (
            {'angles': JointState().position},
            'saw an array in it: make a message with JointState()',
        ),
    ],
)
def test_a_result_that_is_no_message_is_described(notebook, result, seen):
    notebook(f=lambda: result)
    with pytest.raises(CheckFailed) as failed:
        student.call('f', returns=JointState)
    assert seen in str(failed.value)


@pytest.mark.parametrize(
    'reply',
    ['', '{"ok":' * 9_000, '{"ok":{"pickle":"x"}}', '{"failed":"the kernel died"}', None],
)
def test_any_bad_reply_is_a_failed_check(monkeypatch, reply):
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
    monkeypatch.setattr('builtins.input', lambda question: reply)
    with pytest.raises(CheckFailed, match='expected an answer from `f'):
        student.call('f', 2)


@pytest.mark.parametrize(
    'body', [5, True, None, ['a', 'b'], ('a', 5), ('a',), ('a', 'b', 5), ('a',) * 4, {}]
)
def test_malformed_replies_about_nodes_are_ignored(monkeypatch, body):
    monkeypatch.setattr(node_troubles, 'reply_value', lambda request: body)
    assert (node_troubles.last_raised('/a'), node_troubles.blocking_line('/a')) == ('', '')
    assert node_troubles.unpublished_field('/a') == ('', '')
    assert node_troubles.how_answer_ended() == ('', '', '')
    assert node_troubles.has_raised_since('/a', 4) == (body == 5)
    assert not node_troubles.has_raised_since('/a', 5)


def test_requests_to_the_notebook_have_the_agreed_form(monkeypatch):
    asked = []
    monkeypatch.setenv('MY_ROBOT_BASICS_ROOM', 'test')
    monkeypatch.setattr('builtins.input', lambda text: asked.append(text) or '{"ok":1}')
    student.call('f', 2.5)
    student.value('v')
    assert [json.loads(text) for text in asked] == [
        {'protocol': 'my_robot_basics.student/1', 'op': 'call', 'name': 'f', 'args': [2.5]},
        {'protocol': 'my_robot_basics.student/1', 'op': 'value', 'name': 'v', 'args': []},
    ]


def test_the_responder_refuses_another_protocol():
    with pytest.raises(values.WireError):
        responder.answer('{"protocol": "other/1", "op": "call", "name": "f"}')


def test_a_warning_of_the_function_stays_off_stderr(notebook, capsys):
    notebook(f=lambda: print('careful', file=sys.stderr) or 1)
    assert student.call('f') == 1
    assert capsys.readouterr().err == ''


@pytest.mark.starts
def test_the_responder_imports_no_checks():
    code = (
        'import sys; import my_robot_basics.exchange.responder; '
        "print(*sorted(m for m in sys.modules if m.startswith('my_robot_basics')))"
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    modules = 'responder', 'settled', 'values', 'wire', 'wrong_fields'
    names = ['exchange', *(f'exchange.{m}' for m in modules)]
    assert done.stdout.split() == ['my_robot_basics', *(f'my_robot_basics.{n}' for n in names)]


class Raises(Node):
    def __init__(self, name='raises'):
        super().__init__(name)
        self.create_timer(0.02, self.tick)

    def tick(self):
        raise ZeroDivisionError('once more')


class Still(Node):
    def __init__(self):
        super().__init__('raises')


@pytest.mark.starts
def test_an_exception_in_a_callback_is_reported_until_its_node_is_restarted(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    assert node_troubles.last_raised('/raises') == ''
    live.run(Raises)
    live.wait_until(lambda: node_troubles.last_raised('/raises'))
    said = 'ZeroDivisionError: once more \\(.*line \\d+, in tick: raise ZeroDivisionError'
    assert re.match(said, node_troubles.last_raised('/raises'))
    assert what_raised(['/other', '/raises']).startswith('its callback raised ZeroDiv')
    assert what_raised(['/other']) == ''
    live.run(Still, key='Raises')
    assert node_troubles.last_raised('/raises') == ''
    assert not node_troubles.has_raised_since('/raises', 0)
    live.stop()


class OwnSubscriptions(Node):
    def __init__(self):
        super().__init__('own')
        self._subscriptions = {}


class OwnLogger(Node):
    def __init__(self):
        super().__init__('own')
        self._logger = None
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.get_logger().info('tick')


@pytest.mark.starts
def test_an_attribute_of_node_that_a_node_has_overwritten_is_named(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    live.run(Node, 'own')
    assert what_stopped(['/own']) == ''
    live.run(OwnSubscriptions, key='own')
    assert what_stopped(['/own']).startswith('its class assigns to `self._subscriptions`: ')
    live.run(OwnLogger, key='own')
    live.wait_until(lambda: node_troubles.last_raised('/own'))
    raised = r"its callback raised AttributeError: .*'info' .*, because its class assigns to `self"
    assert re.match(raised, what_stopped(['/own']))
    live.stop()


def test_only_names_of_rclpys_attributes_are_believed(monkeypatch):
    told = '_clock'
    monkeypatch.setattr(node_troubles, 'reply_value', lambda question: told)
    assert node_troubles.overwritten_attribute('/a') == '_clock'
    told = 'what a target was'
    assert node_troubles.overwritten_attribute('/a') == ''
    assert {*OWN_ATTRIBUTES} == {*overwritten._KINDS}


@pytest.mark.starts
@pytest.mark.parametrize('end', [live.stop, live.reset])
def test_exceptions_are_forgotten_when_a_node_ends(monkeypatch, end):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    live.run(Raises)
    live.wait_until(lambda: node_troubles.has_raised_since('/raises', 0))
    later_ns = time.monotonic_ns()
    live.wait_until(lambda: node_troubles.has_raised_since('/raises', later_ns))
    end()
    assert node_troubles.last_raised('/raises') == ''
    assert not node_troubles.has_raised_since('/raises', 0)


class Waits(Node):
    def __init__(self):
        super().__init__('waits')
        self.end = threading.Event()
        self.create_timer(0.02, self.tick)

    def tick(self):
        self.end.wait()


@pytest.mark.starts
def test_a_callback_that_does_not_return_is_reported_with_its_line(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    node = live.run(Waits)
    live.wait_until(lambda: node_troubles.blocking_line('/waits'))
    said = r'its callback has not returned \(line \d+: self\.end\.wait\(\)'
    assert re.match(said, what_stopped(['/other', '/waits']))
    assert what_stopped(['/other']) == ''
    node.end.set()
    live.run(Raises)
    live.wait_until(lambda: node_troubles.last_raised('/raises'))
    assert what_stopped(['/raises']).startswith('its callback raised ZeroDiv')
    live.stop()


@pytest.mark.starts
@pytest.mark.parametrize('end', [lambda: live.run(Node, 'next'), live.reset], ids=['next', 'all'])
def test_an_exception_that_ended_a_thread_is_reported_until_a_new_start(monkeypatch, end):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    monkeypatch.setattr(threading, 'excepthook', lambda args: None)
    monkeypatch.setattr(sys, 'unraisablehook', sys.unraisablehook)
    harmless_errors.hide()
    for error in ExternalShutdownException(), ValueError('too far'):
        threading.Thread(target=_raise, args=(error,)).start()
    live.wait_until(lambda: node_troubles.last_raised(wire.THREADS))
    said = r'a thread of the notebook raised ValueError: too far \(.*in _raise: raise error\)'
    assert re.fullmatch(said, what_stopped(['/any']))
    end()
    assert what_stopped(['/any']) == ''
    live.stop()


def _raise(error):
    raise error


def test_the_warning_about_a_client_that_has_gone_is_hidden(monkeypatch):
    monkeypatch.setattr(threading, 'excepthook', threading.excepthook)
    monkeypatch.setattr(sys, 'unraisablehook', sys.unraisablehook)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter('always')
        harmless_errors.hide()
        for what in 'failed to send response (timeout): client will not', 'coroutine was never':
            warnings.warn(what, RuntimeWarning, stacklevel=1)
    assert [str(each.message) for each in told] == ['coroutine was never']


@pytest.mark.starts
def test_a_callback_that_keeps_returning_is_not_called_unfinished(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)
    live.run(Node, 'ticks').create_timer(0.01, lambda: None)
    assert node_troubles.blocking_line('/ticks') == ''
    live.stop()


def test_a_clock_time_as_a_stamp_gets_advice_to_call_to_msg(monkeypatch):
    said = "AttributeError: 'Time' object has no attribute 'sec' (line 3)"
    monkeypatch.setattr(node_troubles, 'last_raised', lambda name: said)
    field = 'header.stamp', 'Time'
    monkeypatch.setattr(node_troubles, 'unpublished_field', lambda name: field)
    assert what_raised(['/any']).endswith('so make a stamp of the time with .to_msg()')


MISSING = 'missing 1 required positional argument:'


@pytest.mark.parametrize(
    ('said', 'advice'),
    [
        (f"TypeError: Arm.tick() {MISSING} 'message'", ", so leave 'message' out of its def"),
        (f"TypeError: Arm.tick() {MISSING} 'self'", ', so give a method as self. and its name'),
        (
            "AttributeError: 'function' object has no attribute 'sec' (line 9, in work: a(b))",
            ', so make a stamp of the time with .to_msg()',
        ),
    ],
)
def test_an_exception_in_a_callback_gets_one_piece_of_advice(monkeypatch, said, advice):
    monkeypatch.setattr(node_troubles, 'last_raised', lambda name: said)
    field = 'header.stamp', 'builtin_interfaces/Time'
    monkeypatch.setattr(node_troubles, 'unpublished_field', lambda name: field)
    why = what_raised(['/any']).replace('\u2068', '').replace('\u2069', '')
    assert advice in why
    assert why.count(', so ') == 1


@pytest.mark.parametrize(
    ('called', 'advice'),
    [
        ('int', 'so give a method by its name'),
        ('rclpy._rclpy_pybind11.Node', 'so give your method'),
    ],
)
def test_a_callback_that_is_not_callable_gets_one_piece_of_advice(monkeypatch, called, advice):
    said = f"TypeError: '{called}' object is not callable"
    monkeypatch.setattr(node_troubles, 'last_raised', lambda name: said)
    monkeypatch.setattr(node_troubles, 'unpublished_field', lambda name: ('', ''))
    why = what_raised(['/any'])
    assert advice in why
    assert why.count(', so ') == 1


def test_the_error_of_rclpy_about_a_wrong_field_is_explained(monkeypatch):
    said = 'TypeError: bad argument type for built-in operation (line 3)'
    monkeypatch.setattr(node_troubles, 'last_raised', lambda name: said)
    assert what_raised(['/any']).endswith('a field of the message holds a value of another type')


@pytest.mark.starts
def test_a_field_of_a_wrong_type_in_a_published_message_is_named(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)

    class Floats(Node):
        def __init__(self):
            super().__init__('floats')
            self.publisher = self.create_publisher(JointState, '/floats', 10)
            self.create_timer(0.01, self.tick)

        def tick(self):
            message = JointState()
            message.header.stamp.sec = 12.5
            self.publisher.publish(message)

    live.run(Floats)
    live.wait_until(lambda: node_troubles.last_raised('/floats'))
    assert node_troubles.unpublished_field('/floats') == ('header.stamp.sec', 'int32')
    assert what_raised(['/floats']).endswith(
        'so give `header.stamp.sec` a value of the type `int32`'
    )
    assert node_troubles.unpublished_field('/others') == ('', '')
    live.stop()


@pytest.mark.starts
def test_logging_a_value_that_is_no_text_is_reported_with_its_line(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)

    class Logs(Node):
        def __init__(self):
            super().__init__('logs')
            self.create_timer(0.01, self.tick)

        def tick(self):
            self.get_logger().info({'elbow_up': 1.0})

    live.run(Logs)
    live.wait_until(lambda: node_troubles.last_raised('/logs'))
    why = what_raised(['/logs'])
    assert ", in tick: self.get_logger().info({'elbow_up': 1.0}))" in why
    assert why.endswith('so log a text: put the value into an f-string')
    live.stop()


@pytest.mark.starts
def test_an_exception_in_a_library_is_reported_with_the_students_line(monkeypatch):
    monkeypatch.delenv('MY_ROBOT_BASICS_ROOM', raising=False)

    class Texts(Node):
        def __init__(self):
            super().__init__('texts')
            self.create_timer(0.01, self.tick)

        def tick(self):
            JointState(position=['0.1'])

    live.run(Texts)
    live.wait_until(lambda: node_troubles.last_raised('/texts'))
    assert "in tick: JointState(position=['0.1'])" in node_troubles.last_raised('/texts')
    live.stop()
