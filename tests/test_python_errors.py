"""What the course adds to exceptions whose own text does not help beginners."""

import asyncio
import inspect
import math
import random
import re
import time

import numpy as np
import pytest
import rclpy
from my_robot_basics.feedback import rclpy_names
from my_robot_basics.feedback.error_words import DECIMAL_COMMA
from my_robot_basics.feedback.python_errors import hint_for_exception, with_hint
from my_robot_basics.graph import stop_reasons
from my_robot_basics.live.output.wrong_arguments import how_to_make
from my_robot_basics.two_link_kinematics import inverse_kinematics
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.verdicts.trouble import describe_cell_error
from nbformat.v4 import new_output
from rcl_interfaces.msg import FloatingPointRange
from rclpy.action import ActionClient, ActionServer
from rclpy.client import Client
from rclpy.duration import Duration
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK
from my_robot_basics import live


class Asker:
    """What a student's class may do."""

    def judge(self, parameters):
        pass

    def describe(self):
        where = 'at index 0 in parameters list'
        raise TypeError(
            f'Third element {FloatingPointRange()} {where} is not a ParameterDescriptor'
        )

    def solve(request, response):  # as a student may write it
        pass

    def get_logger(self, text):
        pass

    def fail(self):
        raise ParameterNotDeclaredException('rate_hz')


class AskerNode(Asker):
    def get_logger(self, text):
        pass


NAMES = {
    **{
        'asyncio': asyncio,
        'time': time,
        'random': random,
        'math': math,
        'inspect': inspect,
        'np': np,
        'rclpy': rclpy,
    },
    **{'FloatingPointRange': FloatingPointRange, 'Asker': Asker},
    **{'Header': Header, 'AskerNode': AskerNode, 'Node': Node, 'Publisher': Publisher},
    **{'Client': Client, 'Duration': Duration},
    'inverse_kinematics': inverse_kinematics,
    'print_it': lambda message: print(message),
    **{'JointState': JointState, 'Parameter': Parameter, 'SolveIK': SolveIK, 'String': String},
}
"""What the lines of code may use."""


DEFINE_IT = ', so check its spelling; in a class of your own, define it before it is used: as '


def error_of(code, **names):
    """What a line of code raises."""
    try:
        exec(code, names)
    except Exception as error:
        return error
    raise AssertionError(f'{code} raises nothing')


NO_AWAIT = 'async def visit():\n    pass\n\n\n'


@pytest.mark.parametrize(
    ('code', 'why'),
    [
        ('time.sleep(0,2)', DECIMAL_COMMA),
        ('float((0, 2))', DECIMAL_COMMA),
        ("float('0,2')", DECIMAL_COMMA),
        ("float('fast')", ''),
        ('time.sleep()', ''),
        ('timer(0，2)', ", so write ',' in its place"),
        ('timer(0。2)', ", so write '.' in its place"),
        ('timer（0.2)', ", so write '(' in its place"),
        ('x = “a”', ", so write '\"' in its place"),
        ('true', ', so write True, False or None with a capital letter'),
        ('base_link', ', so import or define it first, or put it in quotes if it is a text'),
        ('1.0^2', ', so write ** for a power, such as x**2'),
        (
            'np.float64(1)^2',
            ', so write ** for a power, such as x**2',
        ),
        ('1.0 & 2.0', ', so write the words `and` and `or` between comparisons, and not & and |'),
        (
            'np.float64(1) | 2',
            ', so write the words `and` and `or` between comparisons, and not &',
        ),
        ('{}.publishers', ", so write the key in quotes and square brackets: name['key']"),
        ("dict()('publishers')", ", so write the key in quotes and square brackets: name['key']"),
        ('[].append(1, 2)', ', so append one value at a time, or write extend([…])'),
        ('JointState.header.stamp = 1', ', so make an object of the class with parentheses, such'),
        ('JointState().position[0] = 1.0', ', so assign the whole list, [one, two], or append to'),
        ('JointState().name[0] = "a"', ', so assign the whole list, [one, two], or append to it'),
        ('JointState(position=0.5)', ', so write a list, in square brackets, if several numbe'),
        (
            'math.radians("e")',
            ', so give a number, and no text; a loop over a dict, or unpacking',
        ),
        ('math.radians([1, 2])', ', so convert each number by itself: [radians(angle) for angle '),
        (
            'math.hypot((1, 2))',
            ', so convert each number by itself: [radians(angle) for angle in angles]; two '
            'arguments need no inner brackets: hypot(x, y)',
        ),
        ('1.0 / Parameter("hz", value=5.0)', ', so take the value out of the parameter with .val'),
        ('def f():\n    await g()', ', so begin its function with async def'),
        (
            'rclpy.Future().reachable',
            ', so take the answer out of the future with .result(), in the function that '
            'add_done_callback calls, or with `await` in a coroutine: ',
        ),
        (
            f'{NO_AWAIT}" ".join([visit()])',
            ', so put `await` before the call of the async function',
        ),
        (f'{NO_AWAIT}visit().status', ', so put `await` before the call of the async function'),
        (f'{NO_AWAIT}word, end = visit()', ', so put `await` before the call of the async func'),
        ('None.accepted', ', so use the answer in a function that add_done_callback calls: here'),
        ('None.status', ', so use the answer in a function that add_done_callback calls: here it'),
        ('None.reachable', ', so use the answer in a function that add_done_callback calls: here'),
        ('SolveIK.Response(elbow_up={"a": 1})', ', so give a number, and no text; a loop over a'),
        ('rclpy.Future().result.reachable', ', so call it, with parentheses behind its name'),
        ('[].name', ', so go through the list: for each in the_list'),
        ('Asker().judge()', ', so give a callback by its name, without parentheses'),
        ('Node.create_timer(None, 0.2)', ', so give a callback by its name, without parentheses'),
        ('Node.create_publisher(None, JointState, "/a")', ', so give all arguments: the type, '),
        ('Node.create_subscription(None, JointState, "/a")', ', so give all arguments: the ty'),
        ('Node.create_subscription(None, JointState, "/a", max)', ', so give all arguments: the'),
        (
            'Node.create_publisher(None, JointState, "/a", queue_size=10)',
            ', so give the depth of the queue as a whole number alone, such as 10, after',
        ),
        ('Node._validate_qos_or_depth_parameter(None, print_it)', ', so give the depth of the q'),
        ('Node._validate_qos_or_depth_parameter(None, "10")', ', so give the depth of the queue'),
        ('Node.create_client(None, SolveIK)', ''),
        ('Publisher.publish(None)', ''),
        ('Publisher.__new__(Publisher)()', ', so send the message with the method publish of'),
        ('Client.__new__(Client)()', ', so send the request with the method call_async of'),
        ('Client.__new__(Client).async_send_request', ', so send the request with the method'),
        ('Client.__new__(Client).wait_for_server', ''),
        (
            'Client.call_async(None, target=1)',
            ', so give it one request, such as SolveIK.Request(',
        ),
        ('(lambda: 1)(2)', ', so write a parameter for each of them behind lambda, such as lam'),
        ('inverse_kinematics(3.0, 1.0)', ', so catch it: call inverse_kinematics after `try`'),
        ('float(Duration(seconds=0.2))', ', so give the number of seconds itself, such as 0.2'),
        (
            'rclpy.logging.get_logger("a").info("%.2f", 1.0)',
            ', so log a text: put the value into ',
        ),
        ('SolveIK.Request(1.0, 2.0)', ', so write each field with its name, such as SolveIK.Req'),
        ('FloatingPointRange(1.0, 50.0)', ', so write each field with its name, such as Sol'),
        ('JointState(["joint1"])', ', so write each field with its name, such as Point(x=1.2, y='),
        ('Header(1, "base_link")', ', so write each field with its name, such as Point(x=1.2, y='),
        ('Header().seq = 1', ', so look its fields up with ros2 interface show'),
        ('Header().stamp.to_msg()', ', so leave out .to_msg(): this time is a message already'),
        ('rclpy.time.Time.now()', ', so ask a clock for the time: in a node, self.get_clock()'),
        ('rospy.Rate(5)', ', so write what the lesson shows: rospy belongs to ROS 1, and ROS 2'),
        ('import rospy', ', so write what the lesson shows: rospy belongs to ROS 1, and ROS 2'),
        ('self.get_clock()', ', so use self in the methods of a class alone, and make it the fir'),
        ('from sensor_msgs import JointState', ', so import it from the package that has it, '),
        ('x² + y²', ", so write '**2' in its place"),
        ('super(Node, Node.__new__(Node)).init("a")', ', so write super().__init__, with two un'),
        ('{"elbow_up": 1}[0]', ', so use a key that the dict has: print(list(…)) of the dict'),
        ('rclpy.logging.get_logger("a").loginfo("b")', ', so call the method info, warning or '),
        ('x ≤ y', ", so write '<=' in its place"),
        (
            'from std_msgs.msg import JointState',
            ', so import it from the package that has it, such as sensor_msgs.msg for JointState',
        ),
        (
            'Node.__new__(Node).set_parameters_callback',
            ', so write add_on_set_parameters_callback, its name since',
        ),
        ('asyncio.get_running_loop()', ', so wait without asyncio, whose event loop does not run'),
        ('JointState().position += [1.0]', ', so append one value at a time, or assign the whole'),
        ('JointState().position + [1.0]', ', so append one value at a time, or assign the whole'),
        ('[1.0] + JointState().position', ', so append one value at a time, or assign the whole'),
        ("Parameter('targets', value=[1, 2.0])", ', so write numbers of one type in a'),
        ("Parameter('targets', value=[[1.0, 2.0]])", ', so write numbers of one type'),
        ('SolveIK.Request().x', ', so look its fields up with ros2 interface show'),
        ('Asker().describe()', ', so put the range into a list, and that into a descriptor: Para'),
        ('FloatingPointRange()[0]', ', so put the range into a list, and that into a descriptor:'),
        ('Asker().fail()', ', so declare it first, with self.declare_parameter'),
        ('inspect.signature(max)', ', so put it into a function of your own, such as'),
        (
            'with None:\n    pass',
            ', so call rclpy.init() in a line of its own: `with` cannot',
        ),
        ('Asker().solve(1, 2)', ', so write a parameter for each of them into its def, such as '),
        (
            'Asker().get_logger()',
            ', so give your method another name: `Node` already has a method',
        ),
        (
            'AskerNode().get_logger()',
            ', so give your method another name: `Node` already has a method',
        ),
        ('Node.get_logger(None, 1)', ''),
        ('rclpy.Future().done(1)', ''),
        ('random.uniform(1, 2, 3)', ''),
        ('random.uniform()', ''),
        ('1.0 / "5.0"', ', so leave out the quotes around a number, or convert a text to one wi'),
        ('1 + "5"', ''),
        (
            'SolveIK()',
            ', so write its name without parentheses, or SolveIK.Request() for a request',
        ),
        ('x = 5€', ''),
        ('x = (1', ''),
        ('Asker().createTimer(0.2)', ", so write 'create_timer' in its place"),
        ('Asker().GetLogger()', ", so write 'get_logger' in its place"),
        ('Asker().create_publsher(String)', ", so write 'create_publisher' in its place"),
        ('Asker().create_subscriber(String)', ", so write 'create_subscription' in its place"),
        ('from arm_interfaces.srv import SolveIk', ", so write 'SolveIK' in its place"),
        ('from rclpy.node import node', ", so write 'Node' in its place"),
        ('Jointstate()', ", so write 'JointState' in its place"),
        ('PointStamped()', ', so import or define it first'),
        ('jointstate', ', so import or define it first'),
        ('from arm_interfaces.msg import SolveIK', ', so import a message from .msg'),
        ('Asker().create_timer(0.2)', DEFINE_IT),
        ('Asker().publisher', DEFINE_IT),
        ('Asker().tick', DEFINE_IT),
        ('rclpy.Future().tick', ', so take the answer out of the future with .result()'),
        ('rclpy.Context().tick', DEFINE_IT),
        ('None.tick', ''),
        ('[]["rate_hz"]', ', so go through the list: for each in the_list'),
        ('[][0.5]', ''),
        ('from ends import ENDS', ', so check its spelling, and use only modules that the course'),
        ('import sensor_msgs.msgs', ', so check its spelling, and use only modules that the cou'),
        ('import rospy', ', so write what the lesson shows: rospy belongs to ROS 1'),
    ],
)
def test_an_unclear_error_of_python_is_explained_with_what_to_do(code, why):
    error = error_of(code, **NAMES)
    said = hint_for_exception(f'{type(error).__name__}: {error}')
    assert said.startswith(why) if why else said == ''


@pytest.mark.starts
def test_the_error_of_a_second_rclpy_init_is_explained():
    context = rclpy.Context()
    rclpy.init(context=context)
    try:
        error = error_of('rclpy.init(context=context)', rclpy=rclpy, context=context)
    finally:
        context.shutdown()
    said = hint_for_exception(f'{type(error).__name__}: {error}')
    assert said == ', so leave out rclpy.init(): it has been called already'


def test_the_missing_result_of_a_future_is_recognised_by_the_students_line():
    said = "AttributeError: 'NoneType' object has no attribute 'reachable' (line 15, in receive: "
    assert 'add_done_callback' in hint_for_exception(f'{said}if future.result().reachable:)')
    assert 'here it is None' in hint_for_exception(f'{said}if answer.reachable:)')


def test_a_division_by_another_parameter_is_recognised_by_the_students_line():
    said = 'ZeroDivisionError: float division by zero (line 16, in act: period = 1.0 / '
    assert 'also use_sim_time' in hint_for_exception(f'{said}p.value)')
    assert hint_for_exception(f'{said}length)') == ''


def test_none_as_an_empty_list_is_recognised_by_the_students_line():
    said = "TypeError: 'NoneType' object is not iterable (line 16, in solve: "
    assert ', so write []' in hint_for_exception(f'{said}response.elbow_up = None)')
    assert hint_for_exception(f'{said}for angle in angles:)') == ''


def test_a_future_that_was_cancelled_in_place_of_its_goal_is_explained():
    said = "AttributeError: 'NoneType' object has no attribute 'status' (line 28, in end: print("
    assert 'cancel_goal_async(), not its future' in hint_for_exception(f'{said}f.result().status)')


def test_the_status_of_a_rejected_goal_is_explained():
    said = 'KeyError: 0 (line 27, in end: '
    assert 'goal_handle.accepted' in hint_for_exception(f'{said}print(ENDS[f.result().status]))')
    assert 'use a key that' in hint_for_exception(f'{said}print(ENDS[n]))')


def test_a_message_whose_class_was_assigned_to_is_explained():
    class Request(SolveIK.Request):
        __slots__ = ()

    error = error_of('Request.target = 1\nRequest()', Request=Request)
    assert 'and restart the kernel' in hint_for_exception(f'{type(error).__name__}: {error}')


def test_an_unknown_name_in_a_callback_is_explained():
    said = "NameError: name 'math' is not defined (line 8, in f: return math.pi)"
    assert hint_for_exception(said).startswith(', so import or define it first')


def test_a_name_without_a_value_is_explained_unless_it_is_counted_up():
    said = "UnboundLocalError: cannot access local variable 'n' where it is not associated with "
    said += 'a value (line 12, in solve: '
    assert ', so give it a value before' in hint_for_exception(f'{said}print(n))')
    assert hint_for_exception(f'{said}n += 1)') == ''


def test_a_loop_over_the_keys_of_a_dict_is_recognised_by_the_students_line():
    said = 'ValueError: too many values to unpack (expected 2) (line 12, in solve: for a, b in '
    assert hint_for_exception(f'{said}solutions:)') == ', so go through .items() of a dict'
    assert hint_for_exception(f'{said}solutions.items():)') == ''


@pytest.mark.parametrize(
    ('said', 'to_do'),
    [
        ("TypeError: 'Parameter' object is not subscriptable", 'so get its value: self.get_param'),
        (
            "TypeError: main() missing 1 required positional argument: 'args'",
            'def main(args=None)',
        ),
        ("sys:1: RuntimeWarning: coroutine 'main' was never awaited", 'def main without async'),
    ],
)
def test_errors_at_the_start_of_an_executable_are_explained(said, to_do):
    assert to_do in hint_for_exception(said)


def test_an_exhausted_iterator_in_a_coroutine_is_explained():
    said = 'RuntimeError: coroutine raised StopIteration'
    assert hint_for_exception(said) == ', so start again when next(…) finds no more'


LETTERS = ', so write a name of letters from a to z, digits'
REFUSED = {
    'a full-width slash': (
        Node.create_client,
        '／a',
        ", so write '/' in place of '／', a full-width",
    ),
    'a full-width letter': (
        Node.create_publisher,
        'ａ',
        ", so write 'a' in place of 'ａ', a full-",
    ),
    'a full-width colon': (Node.create_publisher, '/a：b', f'{LETTERS}, _ and / alone'),
    'a space': (Node.create_publisher, 'a b', f'{LETTERS}, _ and / alone'),
    'a character that shows nothing': (
        Node.create_publisher,
        'a\u200bb',
        f'{LETTERS}, _ and / alone',
    ),
    'a node': (None, 'ａ／b', ", so write 'a' in place of 'ａ', a full-width character"),
    'a node with a slash': (None, 'a／b', f'{LETTERS} and _ alone'),
    'a node with a hyphen': (None, 'my-node', f'{LETTERS} and _ alone'),
}


@pytest.mark.starts
@pytest.mark.parametrize('case', REFUSED)
def test_a_name_that_ros_refuses_is_explained_with_what_to_write(run, case):
    """The explanation is the same for an error of a cell, on one line, and of a callback."""
    create, name, why = REFUSED[case]
    node = run(Node, 'namer')
    kinds = {Node.create_client: SolveIK, Node.create_publisher: MoveArm.Result}
    try:
        if create is None:
            Node(name)
        else:
            create(node, kinds[create], name, *[1] * (create is Node.create_publisher))
    except Exception as error:
        ename, evalue = type(error).__name__, str(error)
    told = describe_cell_error('a', CellRun(error=new_output('error', ename=ename, evalue=evalue)))
    assert why in told
    assert '^' not in told
    assert why in with_hint(f'its callback raised {ename}: {evalue} (line 4, in f: g(x))')


def test_the_full_stop_of_an_error_is_dropped_before_an_explanation():
    where = 'at index 0 in parameters list'
    said = f'TypeError: Third element 0 {where} is not a ParameterDescriptor'
    assert with_hint(f'{said}.') == said + DECIMAL_COMMA
    assert with_hint('TypeError: not so.') == 'TypeError: not so.'


def test_the_note_on_a_stopped_cell_says_what_to_do():
    said = "'function' object has no attribute 'add_entity'"
    run = CellRun(error=new_output('error', ename='AttributeError', evalue=said))
    told = describe_cell_error('five_hz-run', run)
    assert told == f'your cell `five_hz-run` stopped with AttributeError: {said}{DECIMAL_COMMA}'


@pytest.mark.starts
def test_errors_of_rclpy_about_a_decimal_comma_are_explained(run):
    class Talker(Node):
        def tick(self):
            pass

    node = run(Talker, 'talker')
    for code in 'node.create_timer(0,2, node.tick)', "node.declare_parameter('hz', 5,0)":
        error = error_of(code, node=node)
        assert hint_for_exception(f'{type(error).__name__}: {error}') == DECIMAL_COMMA
    error = error_of('node.create_timer(0.2, node.tick, 10)', node=node)
    assert hint_for_exception(f'{type(error).__name__}: {error}').endswith(', and no queue depth')


@pytest.mark.starts
@pytest.mark.parametrize('default', [[], [0, 0], '', 0.0])
def test_a_parameter_whose_default_is_no_list_of_doubles_is_explained(run, default):
    given = Parameter('targets', value=[1.2, 0.8])
    node = run(Node, 'player', parameter_overrides=[given])
    error = error_of("node.declare_parameter('targets', default)", node=node, default=default)
    said = hint_for_exception(f'{type(error).__name__}: {error}')
    assert said.startswith(', so declare it with doubles, such as [0.0, 0.0]')


ANOTHER_NAME = (
    ', so choose another name: `Node` already has an attribute of this name, and uses it'
)
PROPERTIES = sorted(name for name, kept in vars(Node).items() if isinstance(kept, property))


@pytest.mark.starts
@pytest.mark.parametrize('name', PROPERTIES)
def test_an_assignment_to_a_property_of_node_is_explained(run, name):
    error = error_of(f'node.{name} = []', node=run(Node, 'keeper'))
    assert hint_for_exception(f'{type(error).__name__}: {error}') == ANOTHER_NAME


def test_an_assignment_to_a_property_of_another_class_is_not_explained():
    own = type('Own', (), {'rate': property(lambda self: 5.0)})
    error = error_of('own.rate = 2.0', own=own())
    assert hint_for_exception(f'{type(error).__name__}: {error}') == ''


def test_the_pattern_of_nodes_own_methods_matches_15_methods_of_node():
    names = [name for name in vars(Node) if re.fullmatch(rclpy_names.OWN_METHODS, name)]
    assert 'get_logger' in names
    assert 'create_timer' in names
    assert len(names) == 15


@pytest.mark.starts
def test_a_method_hidden_by_the_property_handle_of_node_is_explained(run):
    """In a class listed after Node among the bases, `self.handle` is rclpy's and not callable."""
    error = error_of('node.handle()', node=run(Node, 'keeper'))
    said = f'{type(error).__name__}: {error}'
    assert hint_for_exception(said).startswith(', so give your method another name than `handle`')


@pytest.mark.starts
def test_a_wrong_interface_type_is_explained_with_the_type_that_is_needed(run):
    node = run(Node, 'asker')
    for code in 'create_client(SolveIK.Request, "/a")', 'create_client(JointState, "/a")':
        error = error_of(f'node.{code}', node=node, **NAMES)
        assert hint_for_exception(f'{error}').startswith(
            ', so give the type of a service, such as Solve'
        )
    error = error_of('node.create_publisher(SolveIK, "/a", 10)', node=node, **NAMES)
    assert hint_for_exception(f'{error}') == ', so give the type of a message, such as JointState'
    error = error_of('node.create_subscription(JointState, "/a", None, 10)', node=node, **NAMES)
    assert hint_for_exception(f'{error}').startswith(
        ', so give it a function that takes one message'
    )


@pytest.mark.starts
def test_a_request_or_goal_of_another_type_is_explained_with_its_constructor(run):
    node = run(Node, 'asker')
    client = node.create_client(SolveIK, '/solve_ik')
    arm = ActionClient(node, MoveArm, '/move_arm')
    request = 'SolveIK.Request(target=…)'
    assert how_to_make(error_of('client.call_async(5)', client=client)) == request
    assert how_to_make(error_of('client.call(5)', client=client)) == request
    goal = 'MoveArm.Goal(position=…, speed=…)'
    assert how_to_make(error_of('arm.send_goal_async([1.0, 2.0])', arm=arm)) == goal
    assert how_to_make(error_of('client.call_async()', client=client)) == ''
    assert how_to_make(error_of('raise TypeError()')) == ''
    assert how_to_make(TypeError()) == ''


@pytest.mark.starts
def test_feedback_of_another_type_is_explained_with_its_constructor(run):
    found = []

    class Server(Node):
        def __init__(self):
            super().__init__('server')
            ActionServer(self, MoveArm, '/some_arm', self.execute)

        def execute(self, goal_handle):
            found.append(error_of('handle.publish_feedback([1.0])', handle=goal_handle))
            goal_handle.succeed()
            return MoveArm.Result()

    run(Server)
    client = ActionClient(run(Node, 'user'), MoveArm, '/some_arm')
    client.wait_for_server(timeout_sec=10.0)
    client.send_goal_async(MoveArm.Goal())
    live.wait_until(lambda: bool(found))
    assert how_to_make(found[0]) == 'MoveArm.Feedback(position=…, remaining=…)'


@pytest.mark.parametrize('state', ['SUCCEEDED', 'CANCELED', 'ABORTED'])
@pytest.mark.parametrize('event', ['SUCCEED', 'CANCELED', 'ABORT'])
def test_a_second_end_of_a_goal_is_explained(state, event):
    said = f'RCLError: goal_handle attempted invalid transition from state {state} with event'
    assert 'call only one of succeed()' in hint_for_exception(f'{said} {event}, at goal_handle.c')


def test_an_end_before_its_request_was_accepted_is_explained():
    said = 'RCLError: goal_handle attempted invalid transition from state EXECUTING with event'
    assert 'after the cancel callback has returned' in hint_for_exception(f'{said} CANCELED')


def test_a_check_adds_the_constructor_to_the_exception_of_a_callback(monkeypatch):
    monkeypatch.setattr(
        stop_reasons.node_troubles, 'last_raised', lambda name: 'TypeError (line 3)'
    )
    kind = '', 'SolveIK.Request(target=…)'
    monkeypatch.setattr(stop_reasons.node_troubles, 'unpublished_field', lambda name: kind)
    wanted = ', so what you give it has to be made with `SolveIK.Request(target=…)`'
    assert stop_reasons.what_raised(['/client']).replace('\u2068', '').replace('\u2069', '') == (
        f'its callback raised TypeError (line 3){wanted}'
    )
