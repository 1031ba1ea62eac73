"""Each node beside a peer in a context of its own, which stands for another process."""

import math
import random
import time
from types import SimpleNamespace

import pytest
import rclpy
from my_robot_basics.hello_node import HelloNode
from my_robot_basics.kinematics_node import KinematicsNode
from my_robot_basics.kinematics_publisher import KinematicsPublisher
from my_robot_basics.kinematics_subscriber import KinematicsSubscriber
from rcl_interfaces.msg import Log
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import LoggingSeverity
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState

TOPIC = '/kinematics/joint_states'
NAMES = ['joint1', 'joint2']


class Peer:
    """A node in another context: publishes on the topic, records the topic and the log."""

    def __init__(self):
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = rclpy.create_node('_peer', context=self.context, enable_rosout=False)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.publisher = self.node.create_publisher(JointState, TOPIC, 10)
        self.received, self.logged = [], []
        self.node.create_subscription(JointState, TOPIC, self.received.append, 1000)
        latched = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.node.create_subscription(Log, '/rosout', self.logged.append, latched)

    def lines(self, severity):
        return [log.msg for log in self.logged if log.level == severity]

    def close(self):
        self.executor.shutdown()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)


@pytest.fixture
def stage(own_domain):
    rclpy.try_shutdown()  # another module's nodes may have left it initialised
    rclpy.init()
    peer, executor = Peer(), SingleThreadedExecutor()

    def run(node_class, **arguments):
        executor.add_node(node_class(**arguments))
        return executor.get_nodes()[0]

    def wait_until(condition, what):
        deadline = time.monotonic() + 20
        while not condition():
            assert time.monotonic() < deadline, f'never happened: {what}; log: {peer.logged}'
            executor.spin_once(timeout_sec=0.002)
            peer.executor.spin_once(timeout_sec=0.002)

    yield SimpleNamespace(run=run, wait_until=wait_until, peer=peer)
    nodes = executor.get_nodes()
    executor.shutdown()
    for node in nodes:
        node.destroy_node()
    peer.close()
    rclpy.try_shutdown()


def joint_state(*positions_deg, names=NAMES):
    return JointState(name=names, position=[math.radians(angle) for angle in positions_deg])


def start_subscriber(stage):
    stage.run(KinematicsSubscriber)
    # the peer's own recording matches too
    stage.wait_until(lambda: stage.peer.publisher.get_subscription_count() == 2, 'a match')
    stage.wait_until(lambda: stage.peer.logged, 'the first log line')


def replies(stage, message):
    """Publish one message; return what the subscriber logs about it, up to its verdict."""
    before = len(stage.peer.logged)
    stage.peer.publisher.publish(message)
    stage.wait_until(
        lambda: any(
            log.msg.startswith(('received', 'ignored')) for log in stage.peer.logged[before:]
        ),
        'an answer',
    )
    return stage.peer.logged[before:]


def test_hello_node_says_hello_once(stage):
    stage.run(HelloNode)
    stage.wait_until(lambda: stage.peer.logged, 'a log line')
    assert [line for line in stage.peer.lines(LoggingSeverity.INFO) if 'Hello' in line]
    assert len(stage.peer.logged) == 1


def test_kinematics_node_logs_fk_and_both_solutions(stage):
    stage.run(KinematicsNode)
    stage.wait_until(lambda: len(stage.peer.logged) >= 3, 'three log lines')
    assert stage.peer.lines(LoggingSeverity.INFO) == [
        'FK: θ1=23.4°, θ2=-67.8° → (1.489, -0.163) m',
        'IK: (1.489, -0.163) m → elbow_up: θ1=23.4°, θ2=-67.8°',
        'IK: (1.489, -0.163) m → elbow_down: θ1=-35.9°, θ2=67.8°',
    ]


def test_publisher_publishes_by_its_timer(stage):
    node = stage.run(KinematicsPublisher)
    assert node.timer.timer_period_ns == 1_000_000_000
    before = node.get_clock().now().nanoseconds
    stage.wait_until(lambda: len(stage.peer.received) >= 2, 'two messages')
    stamps = [
        message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        for message in stage.peer.received
    ]
    assert before < stamps[0] < stamps[1] < node.get_clock().now().nanoseconds


def test_publisher_stays_within_the_joint_ranges_and_uses_them_all(stage):
    node = stage.run(KinematicsPublisher, seed=1)
    stage.wait_until(lambda: node.publisher.get_subscription_count(), 'a match')
    for count in range(1, 201):
        node.publish_pose()
        stage.wait_until(lambda count=count: len(stage.peer.received) >= count, f'message {count}')
    for message in stage.peer.received:
        assert list(message.name) == NAMES
        assert message.header.frame_id == 'base_link'
        assert len(message.position) == 2
        assert not message.velocity
        assert not message.effort
    for index, limit in enumerate((math.radians(90), math.radians(120))):
        angles = [message.position[index] for message in stage.peer.received]
        assert -limit <= min(angles) < -0.9 * limit
        assert 0.9 * limit < max(angles) <= limit


def test_publisher_logs_the_pose_that_it_publishes(stage):
    node = stage.run(KinematicsPublisher)
    node.random = SimpleNamespace(uniform=lambda low, high: 23.4 if high == 90 else -67.8)
    node.publish_pose()
    line = 'published θ1=23.4°, θ2=-67.8° → end effector at (1.489, -0.163) m'
    stage.wait_until(lambda: line in stage.peer.lines(LoggingSeverity.INFO), line)


@pytest.mark.parametrize('node_class', [KinematicsPublisher, KinematicsSubscriber])
def test_the_first_log_line_names_the_remapped_topic(own_domain, node_class, capfd):
    rclpy.try_shutdown()  # another module's nodes may have left it initialised
    rclpy.init(args=['--ros-args', '-r', f'{TOPIC}:=/left/joint_states'])
    node_class().destroy_node()
    rclpy.shutdown()
    assert ' on /left/joint_states' in ''.join(capfd.readouterr())


def test_the_same_seed_gives_the_same_poses(stage):
    node = stage.run(KinematicsPublisher, seed=7)
    stage.wait_until(lambda: node.publisher.get_subscription_count(), 'a match')
    node.publish_pose()
    stage.wait_until(lambda: stage.peer.received, 'a message')
    expected = random.Random(7)
    poses = [
        [math.radians(expected.uniform(-limit, limit)) for limit in (90, 120)] for _ in range(100)
    ]
    # on a busy machine the timer has fired before the two have met
    assert stage.peer.received[0].position.tolist() in poses


def test_the_seed_is_a_read_only_parameter(stage):
    node, other = stage.run(KinematicsPublisher), KinematicsPublisher()
    drawn = node.get_parameter('seed').value
    assert drawn != other.get_parameter('seed').value
    assert node.random.random() == random.Random(drawn).random()
    [result] = node.set_parameters([Parameter('seed', value=drawn + 1)])
    assert result.reason == 'Trying to set a read-only parameter: seed.'
    other.destroy_node()


def test_subscriber_names_the_branch_of_each_pose(stage):
    start_subscriber(stage)
    for pose_deg, verdict in [
        ((23.4, -67.8), 'at (1.489, -0.163) m; IK finds it as elbow_up'),
        ((-35.9, 67.8), 'as elbow_down'),
        ((0, 90), 'at (1.000, 0.800) m; IK finds it as elbow_down'),
        ((170, 100), 'as elbow_down'),
        ((-170, -100), 'as elbow_up'),
        ((0, 0.01), 'as elbow_down'),
        ((10, 0), 'in both branches'),
        ((10, 180), 'in both branches'),
        ((10, -180), 'in both branches'),
        ((23.4 + 720, -67.8 - 360), 'as elbow_up'),
    ]:
        (log,) = replies(stage, joint_state(*pose_deg))
        assert log.level == LoggingSeverity.INFO
        assert verdict in log.msg, pose_deg


@pytest.mark.parametrize(
    ('message', 'warning'),
    [
        (joint_state(1), '2 names but 1 positions'),
        (joint_state(), '2 names but 0 positions'),
        (joint_state(1, 2, names=['joint1']), '1 names but 2 positions'),
        (joint_state(1, 2, names=[]), '0 names but 2 positions'),
        (JointState(), 'no joint1 among the names []'),
        (joint_state(1, 2, names=['joint1', 'elbow']), "no joint2 among the names ['joint1', 'el"),
        (joint_state(1, 2, names=['joint1', 'joint1']), 'no joint2 among the names'),
        (joint_state(math.nan, 2), 'the position of joint1 is nan'),
        (joint_state(1, -math.inf), 'the position of joint2 is -inf'),
        (JointState(name=NAMES, position=[1e308, 0.0]), 'theta1_deg must be finite'),
    ],
)
def test_subscriber_warns_about_a_malformed_message_and_goes_on(stage, message, warning):
    start_subscriber(stage)
    (log,) = replies(stage, message)
    assert log.level == LoggingSeverity.WARN
    assert log.msg.startswith('ignored a message')
    assert warning in log.msg
    (log,) = replies(stage, joint_state(23.4, -67.8))
    assert 'as elbow_up' in log.msg


def test_subscriber_matches_reordered_joints_by_name_and_warns(stage):
    start_subscriber(stage)
    warning, answer = replies(stage, joint_state(-67.8, 23.4, names=['joint2', 'joint1']))
    assert warning.level == LoggingSeverity.WARN
    assert "['joint2', 'joint1']: the angles are taken by name" in warning.msg
    assert 'θ1=23.4°, θ2=-67.8°' in answer.msg


def test_subscriber_ignores_other_joints(stage):
    start_subscriber(stage)
    gripper = joint_state(math.nan, 23.4, -67.8, names=['gripper', 'joint1', 'joint2'])
    (log,) = replies(stage, gripper)
    assert 'θ1=23.4°, θ2=-67.8°' in log.msg
