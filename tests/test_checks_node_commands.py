"""Two command lines that start one program twice: each way to write them, and each mistake."""

import math
import random
import sys

import pytest
from my_robot_basics.checks import CheckFailed, node_command
from my_robot_basics.checks.nodes.started_node import started_node
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.live.packages import commands
from my_robot_basics.ros2 import command_line
from rclpy.node import Node
from sensor_msgs.msg import JointState

from my_robot_basics import live

pytestmark = pytest.mark.starts
START = 'ros2 run my_robot_basics kinematics_publisher --ros-args'
TOPIC = '/kinematics/joint_states'
LEFT = f'{START} -r __ns:=/left -r __node:=arm -r {TOPIC}:=/left/joint_states'
RIGHT = f'{START} -r __ns:=/right -r __node:=arm -r {TOPIC}:=joint_states -p seed:=7'


@pytest.fixture
def start(monkeypatch):
    # a slow start is not what these tests are about
    monkeypatch.setattr(commands, 'STARTED_SEC', 60.0)

    def start(left=LEFT, right=RIGHT):
        for name, text in ('left_arm', left), ('right_arm', right):
            monkeypatch.setattr(sys.modules['__main__'], name, text, raising=False)
        live.run_commands('left_arm', 'right_arm')

    yield start
    live.stop()


def look():
    left = node_command('left_arm', '/left/arm')
    right = node_command('right_arm', '/right/arm')
    left.expect_publishes('/left/joint_states', instead_of=TOPIC)
    right.expect_publishes('/right/joint_states', instead_of=TOPIC)
    right.expect_parameter('seed', 7)
    right.expect_poses('/right/joint_states', seed=7)


FILE = """
/**:
  ros__parameters:
    seed: 7
"""


@pytest.mark.slow
def test_full_and_relative_names_pass(start):
    start()
    look()


@pytest.mark.slow
def test_quotes_long_options_and_a_file_pass(start, tmp_path):
    (tmp_path / 'a file.yaml').write_text(FILE)
    start(
        left=f'{START} --remap "__ns:=/left" --remap \'__node:=arm\' \\\n'
        f' -r {TOPIC}:=joint_states',
        right=f'{START} -r __name:=arm -r __ns:=/right -r {TOPIC}:=/right/joint_states '
        f'--params-file "{tmp_path}/a file.yaml"',
    )
    look()


MISTAKES = [
    ('-r __node:=arm', 'saw .*/arm.*: a namespace is given by a rule of its own: -r __ns:=/right'),
    ('-r __ns:=right -r __node:=arm', 'a namespace begins with /: write -r __ns:=/right'),
    ('-r __ns:=/right', 'a name is given by a rule of its own: -r __node:=arm'),
    ('-r __node:=/right/arm -r __ns:=/right', 'a name has no /, the namespace is in the other'),
    ('-r __ns:=/rigth -r __node:=arm', 'saw .*/rigth/arm: compare both names in the rules'),
    ('-r __ns:=/right/ -r __node:=arm', 'has no / at its end: write -r __ns:=/right'),
    ('-r __ns:=/right -r __node:=arm -p seed:=7.0', 'see whether the node has ended'),
    ('-r __ns:=/right -r __node:=arm -p seed=7', "written name:=value: 'seed=7' is none"),
    ('-r __ns:=/right -r __node:=arm -p /right/arm:seed:=7', 'parameter alone, -p seed:=…'),
    (f'-r __ns:=/right -r __node:=arm -r {TOPIC}:=joint_states -p arm:seed:=7',
     r'seed = 7 of /right/arm, saw \d+: arm:seed gives the node no seed: the command line is of'),
    ('-r __ns:=/right -r __node:=arm -r seed:=7', 'give the parameter with -p seed:=7'),
    ('-r __ns:=/right -r __node:=arm', 'saw it publishes on /kinematics/joint_states: the name of '
     'the topic begins with /, so no namespace moves it'),
    ('-r __ns:=/right -r __node:=arm -r kinematics/joint_states:=joint_states',
     'kinematics/joint_states means /right/kinematics/joint_states here'),
    (f'-r __ns:=/right -r __node:=arm -r {TOPIC}:=right/joint_states',
     'right/joint_states means /right/right/joint_states here'),
    (f'-r __ns:=/right -r __node:=arm -r {TOPIC}:=/joint_states', 'compare the rule with the na'),
    (f'-r __ns:=/right -r __node:=arm -r {TOPIC}:=joint_states',
     r'expected seed = 7 of /right/arm, saw \d+: give it with -p seed:=7'),
]  # fmt: skip


@pytest.mark.parametrize(('rest', 'words'), MISTAKES, ids=[rest for rest, _ in MISTAKES])
def test_each_mistake_in_a_command_line_is_named(start, rest, words):
    start(right=f'{START} {rest}')
    with pytest.raises(CheckFailed, match=words):
        look()


@pytest.mark.slow
def test_two_publishers_on_one_topic_are_named(start):
    start(left=LEFT, right=RIGHT.replace(':=joint_states', ':=/left/joint_states'))
    words = 'expected one publisher on /left/joint_states, saw /left/arm, /right/arm'
    with pytest.raises(CheckFailed, match=words):
        look()


def test_a_command_line_of_another_executable_fails(start, monkeypatch):
    start()
    monkeypatch.setattr(sys.modules['__main__'], 'left_arm', 'ros2 run my_robot_basics hello_node')
    with pytest.raises(
        CheckFailed, match='expected `left_arm` to be one command line that starts'
    ):
        look()


@pytest.mark.slow
def test_poses_of_another_seed_fail(start):
    start(left=LEFT + ' -p seed:=8')
    left = node_command('left_arm', '/left/arm')
    with pytest.raises(CheckFailed, match='expected a pose of the seed 7 on /left/joint_states'):
        left.expect_poses('/left/joint_states', seed=7)


class Arm(Node):
    """A node of the notebook that looks like one of a command line."""

    def __init__(self, side, seed):
        super().__init__('arm', namespace=f'/{side}')
        self.declare_parameter('seed', seed)
        self.random = random.Random(seed)
        self.poses = self.create_publisher(JointState, f'/{side}/joint_states', 10)
        self.create_timer(1.0, self.publish)

    def publish(self):
        pose_deg = self.random.uniform(-90.0, 90.0), self.random.uniform(-120.0, 120.0)
        self.poses.publish(JointState(position=[math.radians(angle) for angle in pose_deg]))


@pytest.mark.slow
def test_nodes_that_the_command_lines_did_not_start_are_refused(start):
    start(left=START, right=START)
    live.run(Arm, 'left', 1, key='left')
    live.run(Arm, 'right', 7, key='right')
    words = (
        'expected /left/arm to be the node of the command line, saw the node /kinematics_publisher'
    )
    with pytest.raises(CheckFailed, match=words):
        look()


@pytest.mark.parametrize(
    ('options', 'found'),
    [
        ('-r __ns:=/a -r __node:=b', ('/a/b', TOPIC, None)),
        (f'-r __ns:=/a -r {TOPIC}:=c', ('/a/kinematics_publisher', '/a/c', None)),
        ('-r __ns:=/a -r joint_states:=c', ('/a/kinematics_publisher', TOPIC, None)),
        ('-r kinematics_publisher:__node:=b -p seed:=7 -p seed:=8', ('/b', TOPIC, 8)),
        ('-p seed:=7 --params-file nowhere.yaml', ('/kinematics_publisher', TOPIC, 7)),
    ],
)
def test_a_command_line_is_read_as_rcl_reads_it(options, found):
    started = read(options)
    assert (started.name, started.topic_name, started.parameter) == found
    assert started.has_file == ('--params-file' in options)


@pytest.mark.parametrize(
    'options',
    [
        *('-r __ns:=a', '-r __node:=a/b', '-r c', '-p seed:={', '-p use_sim_time:=3'),
        f'-r {TOPIC}:=' + 'a' * 300,
    ],
    ids=range(6),
)
def test_a_command_line_that_rcl_refuses_yields_no_node(options):
    assert read(options) is None


def read(options):
    line = command_line.parse(
        f'{START} {options}', package='my_robot_basics', executable='kinematics_publisher'
    )
    return started_node(
        line, node_name='kinematics_publisher', topic_name=TOPIC, parameter_name='seed'
    )


def test_a_node_made_to_read_a_command_line_is_not_discovered(monkeypatch):
    met, destroy = [], Node.destroy_node
    with Watcher() as watcher:

        def look_first(node):
            if node.get_name() == 'b':
                watcher.spin_for(0.5)
                met.append(node.get_fully_qualified_name() in graphs.node_names(watcher.node))
            destroy(node)

        monkeypatch.setattr(Node, 'destroy_node', look_first)
        assert read('-r __ns:=/a -r __node:=b').name == '/a/b'
    assert met == [False]
