"""What the course adds to exceptions of rclpy after a wrong call or a wrong name.

The exceptions are those that rclpy and Python raise, of the versions that are installed.
"""

import inspect
import math

import pytest
import rclpy
from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.error_words import DECIMAL_COMMA
from my_robot_basics.feedback.python_errors import hint_for_exception, with_hint
from my_robot_basics.graph import stop_reasons
from my_robot_basics.graph.watcher import Watcher
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64MultiArray, Int32, String

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK

NAMES = {
    **{'math': math, 'rclpy': rclpy, 'Node': Node, 'Parameter': Parameter, 'Duration': Duration},
    **{'ActionClient': ActionClient, 'ActionServer': ActionServer, 'Publisher': Publisher},
    **{'ServerGoalHandle': ServerGoalHandle, 'MoveArm': MoveArm, 'SolveIK': SolveIK},
    **{'GoalResponse': GoalResponse, 'CancelResponse': CancelResponse, 'QoSProfile': QoSProfile},
    **{'ReliabilityPolicy': ReliabilityPolicy, 'DurabilityPolicy': DurabilityPolicy},
    **{'qos_profile_sensor_data': qos_profile_sensor_data, 'JointState': JointState},
    **{'Bool': Bool, 'Float64MultiArray': Float64MultiArray, 'Int32': Int32, 'String': String},
    'unwrap': inspect.unwrap,  # `live` gives better advice, but does not run in a program
    'began': Duration(seconds=0.5),
    'client': ActionClient.__new__(ActionClient),
    'handle': ServerGoalHandle.__new__(ServerGoalHandle),
    'sent': ClientGoalHandle.__new__(ClientGoalHandle),
    'parameter': Parameter('rate_hz', value=5.0),
}
"""What the lines of code may use."""

DATA = ', so write the field with its name, such as String(data=…)'
PUBLISH = ', so publish a message of the type of the topic, such as String(data=…)'
PARTS = ', so put the fields into SolveIK.Request(…) for a service, or MoveArm.Goal(…) for an'
DOT = ', so write a dot and the name of the field, such as .elbow_up, and no square brackets'
DEPTH = ', so add the depth of the queue: QoSProfile(depth=1, …)'
NAMED = ', so write each value with its name: `QoSProfile(depth=1, reliability=…, durability=…)`'
SPELLED = ', so check how each of them is spelled: `QoSProfile(depth=…, reliability=…, dur'
NO_SERVICE_DEPTH = ', so give create_service the type, the name and the callback alone: a service'
NO_CLIENT_DEPTH = ', so give create_client the type and the name alone: a client needs no queue'
CALLBACKS = ', so write the names of all further arguments: goal_callback=…, cancel_callback=…'
SERVER = ', so give it the node, the type, the name and the execute callback: ActionServer(self, '
CLIENT = ", so give it the node, the type and the name alone: ActionClient(self, MoveArm, '/move"
OF_GOAL = ', so call this method of the goal handle: it is the result of the future that send_goal'
NO_RESULT = ', so call it without an argument, and return the result: return MoveArm.Result(posit'
ENDS = ', so end the goal with a method that it has: goal_handle.succeed(), goal_handle.cance'
REQUEST = ', so look into goal_handle.request, which has the fields of the goal'
ACCEPT = ', so write ACCEPT or REJECT: GoalResponse and CancelResponse have these two names'
VALUE = ', so take the value out of the parameter with .value'
NO_GET_VALUE = ', so write .value in place of .get_parameter_value()'
SECONDS = ', so take the seconds out of the duration with .nanoseconds / 1e9'
TEXT = ', so take its text with str(), such as str(error)'
EACH_ANGLE = ', so convert each number by itself: [radians(angle) for angle in angles]; two argume'
DOT_SRV = (
    ', so import a message from .msg, a service such as SolveIK from .srv, and an action such'
)
FROM_PACKAGE = (
    ', so import it from the package that has it, such as sensor_msgs.msg for JointState'
)


def error_of(code, **names):
    """What a line of code raises."""
    try:
        exec(code, names)
    except Exception as error:
        return error
    raise AssertionError(f'{code} raises nothing')


def hint_of(error):
    return hint_for_exception(f'{type(error).__name__}: {error}')


@pytest.mark.parametrize(
    ('code', 'why'),
    [
        ("String('rejected')", DATA),
        ('Int32(3)', DATA),
        ('Bool(True)', DATA),
        ('Float64MultiArray([1.0])', DATA),
        ('Duration(0.5)', ', so write the unit with the number: Duration(seconds=0.2)'),
        ('SolveIK(target=None)', PARTS),
        ('SolveIK(1.0)', PARTS),
        ('MoveArm(position=[1.2, 0.8], speed=1.0)', PARTS),
        ('MoveArm()', ', so write its name without parentheses, or MoveArm.Goal() for a goal'),
        ("SolveIK.Response()['elbow_up']", DOT),
        ("MoveArm.Result()['position']", DOT),
        ("JointState()['position']", DOT),
        ("String()['data']", DOT),
        ("rclpy.Future()['elbow_up']", ', so take the answer out of the future with .result()'),
        ("Publisher.publish(None, data='rejected')", PUBLISH),
        ('QoSProfile(reliability=ReliabilityPolicy.RELIABLE)', DEPTH),
        ('QoSProfile(1, ReliabilityPolicy.RELIABLE, DurabilityPolicy.VOLATILE)', NAMED),
        ('QoSProfile(1)', NAMED),
        ('QoSProfile(depth=1, durabilty=DurabilityPolicy.VOLATILE)', SPELLED),
        ('qos_profile_sensor_data()', ', so write its name without parentheses: it is a profile'),
        ("Node.create_service(None, SolveIK, '/solve_ik', print, 10)", NO_SERVICE_DEPTH),
        ("Node.create_client(None, SolveIK, '/solve_ik', 10)", NO_CLIENT_DEPTH),
        ("Node.create_client(None, SolveIK, '/solve_ik', print, 10)", NO_CLIENT_DEPTH),
        ("ActionServer(None, MoveArm, '/move_arm', print, print, print)", CALLBACKS),
        ("unwrap(ActionServer.__init__)(None, MoveArm, '/move_arm', print)", SERVER),
        ("unwrap(ActionClient.__init__)(None, MoveArm, '/move_arm')", CLIENT),
        ("ActionClient(None, MoveArm, '/move_arm', 10)", CLIENT),
        ('client.cancel_goal_async()', OF_GOAL),
        ('client.get_result_async()', OF_GOAL),
        ('client.tick()', ''),
        ('ServerGoalHandle.succeed(None, MoveArm.Result())', NO_RESULT),
        ('ServerGoalHandle.canceled(None, MoveArm.Result())', NO_RESULT),
        ('handle.set_succeeded()', ENDS),
        ('handle.cancelled()', ENDS),
        ('handle.position', REQUEST),
        ('handle.is_preempt_requested', ', so look at goal_handle.is_cancel_requested'),
        ('bool(1)()', ', so write no parentheses behind what is True or False'),
        ('sent.is_accepted', ', so look at goal_handle.accepted, which is True or False'),
        ('GoalResponse.ACCEPTED', ACCEPT),
        ('GoalResponse.accept', ACCEPT),
        ('CancelResponse.ACCEPTED', ACCEPT),
        ('CancelResponse.REJECTED', ACCEPT),
        ('1.0 / parameter', VALUE),
        ('parameter > 1.0', VALUE),
        ('float(parameter)', VALUE),
        ('math.sin(parameter)', VALUE),
        ('round(parameter)', VALUE),
        ('parameter.double_value', VALUE),
        ('parameter.get_value()', VALUE),
        ('1.0 / parameter.get_parameter_value()', NO_GET_VALUE),
        ('float(parameter.get_parameter_value())', NO_GET_VALUE),
        ('math.sin(parameter.get_parameter_value())', NO_GET_VALUE),
        ('parameter.get_parameter_value().value', NO_GET_VALUE),
        ('began.seconds', SECONDS),
        ('began.sec', SECONDS),
        ('began.to_sec()', SECONDS),
        ('began > 0.5', SECONDS),
        ('1.0 / began', SECONDS),
        ('began.microseconds', ''),
        ('math.radians(JointState(position=[1.0]).position)', EACH_ANGLE),
        ("ValueError('far').message", TEXT),
        ('rclpy.exceptions.ROSInterruptException().msg', TEXT),
        ("ValueError('far').reason", ', so check its spelling; in a class of your own'),
        ('from arm_interfaces.msg import SolveIK', DOT_SRV),
        ('from arm_interfaces.msg import MoveArm', DOT_SRV),
        ('from arm_interfaces.srv import MoveArm', DOT_SRV),
        ('from arm_interfaces.action import SolveIK', DOT_SRV),
        ('from arm_interfaces import SolveIK', DOT_SRV),
        ('from std_msgs.srv import String', DOT_SRV),
        ('from sensor_msgs.srv import JointState', FROM_PACKAGE),
        ('import std_msgs.messages', ', so check its spelling, and use only modules that the cou'),
    ],
)
def test_a_wrong_call_or_name_is_explained_with_what_to_write(code, why):
    said = hint_of(error_of(code, **NAMES))
    assert said.startswith(why) if why else said == ''


@pytest.mark.starts
def test_what_is_no_message_of_the_topic_is_explained_by_how_to_make_one(run):
    publisher = run(Node, 'talker').create_publisher(String, '/state', 10)
    for given in "'rejected'", '3', '[1.0]', 'Int32(data=3)':
        error = error_of(f'publisher.publish({given})', publisher=publisher, **NAMES)
        assert hint_of(error) == PUBLISH
    error = error_of('publisher.publish(String)', publisher=publisher, **NAMES)
    assert hint_of(error).startswith(', so make an object of the class with parentheses')


@pytest.mark.starts
def test_the_depth_of_a_service_is_explained_as_an_argument_with_a_name_too(run):
    node = run(Node, 'asker')
    for create in "create_client(SolveIK, '/a',", "create_service(SolveIK, '/a', print,":
        error = error_of(f'node.{create} qos_profile=10)', node=node, **NAMES)
        assert hint_of(error) == ', so leave out this depth: services and actions need none'


@pytest.mark.starts
@pytest.mark.parametrize(
    ('given', 'has_comma'),
    [
        ('5,0', True),
        ('0,25', True),
        ('Parameter.Type.DOUBLE, 5.0', False),
        ('1.0, -1', False),
        ("5.0, 'the rate'", False),
        ('5.0, [1.0, 50.0]', False),
        ('5.0, True', False),
        ("5.0, '2 Hz'", False),
    ],
)
def test_only_a_whole_number_behind_the_value_of_a_parameter_may_be_a_decimal_comma(
    run, given, has_comma
):
    error = error_of(f"node.declare_parameter('rate_hz', {given})", node=run(Node, 'a'), **NAMES)
    own = ", so give the name and the value alone, such as declare_parameter('rate_hz', 5.0): a t"
    assert hint_of(error).startswith(DECIMAL_COMMA if has_comma else own)


@pytest.mark.parametrize(
    ('told', 'why'),
    [
        ('AttributeError: ACCEPTED (line 12, in judge: return GoalResponse.ACCEPTED)', ACCEPT),
        (
            "AttributeError: 'MoveArm_Result' object has no attribute 'status' (line 22, in end)",
            ', so leave .result out: the status is beside the result, future.result().status',
        ),
        (
            "TypeError: unhashable type: 'ClientGoalHandle' (line 20, in drive)",
            ', so keep goal handles in a list, or in a dict with '
            'bytes(goal_handle.goal_id.uuid) as the key',
        ),
        (
            'TypeError: MoveArmClient.respond() takes 1 positional argument but 2 were given',
            ', so write a parameter for each of them into its def, such as (self, request, '
            'response) for a service, (self, message) for a subscription, (self, future) for '
            'add_done_callback, and (self) for a timer',
        ),
        (
            "TypeError: Expected <class 'std_msgs.msg._string.String'>, got <class 'sensor_ms… "
            '(line 9, in <lambda>: self.create_subscription(kind, topic, lambda m: out.publish(m)',
            ', so publish a message of the type of the topic; in a loop, write lambda message, '
            'publisher=publisher: …, or each lambda uses the publisher of the last round',
        ),
        (
            'KeyError: 0 (line 27, in end: print(ENDS[future.result().status]))',
            ', so look at goal_handle.accepted first: a rejected goal has no result, and its '
            'status is 0',
        ),
    ],
)
def test_marks_around_the_text_of_an_exception_do_not_hide_what_it_is(monkeypatch, told, why):
    """In the hidden part of a check, marks surround what the student's code made."""
    monkeypatch.setattr(hidden, '_quiet', True)
    monkeypatch.setattr(stop_reasons.node_troubles, 'last_raised', lambda name: told)
    monkeypatch.setattr(stop_reasons.node_troubles, 'unpublished_field', lambda name: ('', ''))
    assert stop_reasons.what_raised(['/arm']).endswith(f'\u2069{why}')


@pytest.mark.parametrize('name', ['GoalResponse', 'CancelResponse'])
def test_a_wrong_response_is_explained_in_the_words_of_python_3_12_too(name):
    said = f"AttributeError: type object '{name}' has no attribute 'ACCEPTED'"
    assert with_hint(said) == said + ACCEPT


@pytest.mark.starts
@pytest.mark.parametrize(
    'code',
    [
        "node.create_subscription(Int32, '/solve_ik', print, 10)",
        "node.create_publisher(Int32, '/solve_ik', 10)",
    ],
)
def test_a_second_type_of_a_topic_leads_to_advice_about_its_other_ends(code):
    with Watcher() as here:
        here.node.create_publisher(String, '/solve_ik', 10)
        error = error_of(code, node=here.node, Int32=Int32)
    assert hint_of(error).startswith(', so see which type the other ends of this name have')
