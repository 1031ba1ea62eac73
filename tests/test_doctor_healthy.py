"""No fault is found in healthy systems: random ones, which resemble the faulty ones."""

import math
import random
import time

import pytest
from builtin_interfaces.msg import Time
from my_robot_basics.doctor.diagnosing import diagnose
from my_robot_basics.doctor.report import tell
from my_robot_basics.live import run, stop
from my_robot_basics.session import classroom
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

NAMES = (
    '/kinematics/joint_states',
    '/joint_states',
    '/kinematics/joint_state',
    '/Kinematics/joint_states',
    '/arm/left/joint_states',
)


class Talker(Node):
    def __init__(self, name, topic_name, type_, qos_profile, rate_hz, **kwargs):
        super().__init__(name, **kwargs)
        self.type = type_
        self.publisher = self.create_publisher(type_, topic_name, qos_profile)
        self.timer = self.create_timer(1.0 / rate_hz, self.publish)

    def publish(self):
        message = self.type()
        if self.type is JointState:
            message.header.stamp = self.get_clock().now().to_msg()
            message.name = ['joint1', 'joint2']
            message.position = [random.uniform(-math.pi, math.pi) for _ in message.name]
        self.publisher.publish(message)


class Listener(Node):
    def __init__(self, name, topic_name, type_, qos_profile, **kwargs):
        super().__init__(name, **kwargs)
        self.create_subscription(type_, topic_name, lambda message: None, qos_profile)


class WallClock(Node):
    """Drives /clock at the pace of the wall clock, an hour behind it."""

    def __init__(self):
        super().__init__('simulator')
        self.publisher = self.create_publisher(Clock, '/clock', 10)
        self.timer = self.create_timer(0.02, self.publish)

    def publish(self):
        nanoseconds = time.time_ns() - 3600 * 10**9
        stamp = Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        self.publisher.publish(Clock(clock=stamp))


def offer_and_wish(rng):
    """Return an offered and a requested QoS profile that match."""
    reliable, keeps = rng.random() < 0.5, rng.random() < 0.5
    offer = QoSProfile(
        depth=rng.randint(1, 50),
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if keeps else DurabilityPolicy.VOLATILE,
    )
    wish = QoSProfile(
        depth=rng.randint(1, 50),
        reliability=ReliabilityPolicy.RELIABLE
        if reliable and rng.random() < 0.7
        else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL
        if keeps and rng.random() < 0.7
        else DurabilityPolicy.VOLATILE,
    )
    if rng.random() < 0.2:
        offer.deadline, wish.deadline = Duration(seconds=2), Duration(seconds=3)
    return offer, wish


def start_system(rng):
    """Start one to three topics with both ends each, and return the topic to ask about."""
    simulated = rng.random() < 0.25
    options = {}
    if simulated:
        run(WallClock)
        options['parameter_overrides'] = [Parameter('use_sim_time', value=True)]
    elif rng.random() < 0.2:
        options['start_parameter_services'] = False
    topic_names = rng.sample(NAMES, rng.randint(1, 3))
    for i, topic_name in enumerate(topic_names):
        type_ = rng.choice([JointState, JointState, String])
        offer, wish = offer_and_wish(rng)
        # only the first topic, which is asked about, always has a listener
        for j in range(rng.randint(1, 2)):
            name = f'talker_{i}_{j}'
            rate_hz = rng.choice([1, 5, 20, 100])
            run(Talker, name, topic_name, type_, offer, rate_hz, key=name, **options)
        if i == 0 or rng.random() < 0.6:
            for j in range(rng.randint(1, 2)):
                name = f'listener_{i}_{j}'
                run(Listener, name, topic_name, type_, wish, key=name, **options)
    return topic_names[0]


def assert_well(seed):
    try:
        topic_name = start_system(random.Random(seed))
        (diagnosis,) = diagnose(topic_name, domain_id=classroom.enter())
    finally:
        stop()
    assert not diagnosis.findings, f'seed {seed}: {tell(diagnosis)}'
    assert diagnosis.evidence.rate_hz > 0.0


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(6))
def test_no_fault_is_found_in_half_a_dozen_healthy_systems(seed):
    assert_well(seed)


@pytest.mark.slow
@pytest.mark.parametrize('seed', range(1000, 1200))
def test_no_fault_is_found_in_two_hundred_healthy_systems(seed):
    assert_well(seed)
