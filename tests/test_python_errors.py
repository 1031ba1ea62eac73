"""What is said of exceptions whose own words do not tell beginners what to do."""

import time

import pytest
from my_robot_basics.feedback.python_errors import DECIMAL_COMMA, explained, what_to_do
from my_robot_basics.graph import raised
from my_robot_basics.live.bare_errors import made_with
from my_robot_basics.validate.outputs import CellRun
from my_robot_basics.validate.trouble import trouble_in
from nbformat.v4 import new_output
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from arm_interfaces.action import MoveArm
from arm_interfaces.srv import SolveIK
from my_robot_basics import live


def error_of(code, **names):
    """What a line of code raises."""
    try:
        exec(code, names)
    except Exception as error:
        return error
    raise AssertionError(f'{code} raises nothing')


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
        ('x = 5€', ''),
        ('x = (1', ''),
    ],
)
def test_commas_and_full_width_characters_are_told(code, why):
    error = error_of(code, time=time)
    assert what_to_do(f'{type(error).__name__}: {error}') == why


LETTERS = ', so write a name of letters from a to z, digits'
NAMES = {
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
@pytest.mark.parametrize('case', NAMES)
def test_a_name_that_ros_refuses_is_told_with_what_to_write(run, case):
    """Both where a cell raises it, on one line, and where a callback does."""
    create, name, why = NAMES[case]
    node = run(Node, 'namer')
    kinds = {Node.create_client: SolveIK, Node.create_publisher: MoveArm.Result}
    try:
        if create is None:
            Node(name)
        else:
            create(node, kinds[create], name, *[1] * (create is Node.create_publisher))
    except Exception as error:
        ename, evalue = type(error).__name__, str(error)
    told = trouble_in('a', CellRun(error=new_output('error', ename=ename, evalue=evalue)))
    assert why in told
    assert '^' not in told
    assert why in explained(f'its callback raised {ename}: {evalue} (line 4, in f: g(x))')


def test_a_full_stop_does_not_stand_before_a_comma():
    said = 'TypeError: Third element 0 in parameters list is not a ParameterDescriptor'
    assert explained(f'{said}.') == said + DECIMAL_COMMA
    assert explained('TypeError: not so.') == 'TypeError: not so.'


def test_the_note_on_a_cell_tells_what_to_do():
    said = "'function' object has no attribute 'add_entity'"
    run = CellRun(error=new_output('error', ename='AttributeError', evalue=said))
    told = trouble_in('five_hz-run', run)
    assert told == f'your cell `five_hz-run` stopped with AttributeError: {said}{DECIMAL_COMMA}'


@pytest.mark.starts
def test_rclpy_itself_says_so_of_a_decimal_comma(run):
    class Talker(Node):
        def tick(self):
            pass

    node = run(Talker, 'talker')
    for code in 'node.create_timer(0,2, node.tick)', "node.declare_parameter('hz', 5,0)":
        error = error_of(code, node=node)
        assert what_to_do(f'{type(error).__name__}: {error}') == DECIMAL_COMMA


@pytest.mark.starts
def test_what_rclpy_refuses_without_a_word_is_told_with_how_to_make_it(run):
    node = run(Node, 'asker')
    client = node.create_client(SolveIK, '/solve_ik')
    arm = ActionClient(node, MoveArm, '/move_arm')
    request = 'SolveIK.Request(target=…)'
    assert made_with(error_of('client.call_async(5)', client=client)) == request
    assert made_with(error_of('client.call(5)', client=client)) == request
    goal = 'MoveArm.Goal(position=…, speed=…)'
    assert made_with(error_of('arm.send_goal_async([1.0, 2.0])', arm=arm)) == goal
    assert made_with(error_of('client.call_async()', client=client)) == ''
    assert made_with(error_of('raise TypeError()')) == ''
    assert made_with(TypeError()) == ''


@pytest.mark.starts
def test_feedback_of_another_type_is_told_with_how_to_make_it(run):
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
    assert made_with(found[0]) == 'MoveArm.Feedback(position=…, remaining=…)'


def test_a_check_puts_it_behind_what_was_raised(monkeypatch):
    monkeypatch.setattr(raised.node_troubles, 'last_raised', lambda name: 'TypeError (line 3)')
    kind = '', 'SolveIK.Request(target=…)'
    monkeypatch.setattr(raised.node_troubles, 'unpublished_field', lambda name: kind)
    wanted = ', so what you give it has to be made with `SolveIK.Request(target=…)`'
    assert raised.what_raised(['/client']).replace('\u2068', '').replace('\u2069', '') == (
        f'its callback raised TypeError (line 3){wanted}'
    )
