"""A node that passes messages on is judged by what it publishes, with any QoS of its own."""

import pytest
from my_robot_basics.checks import CheckFailed, relay
from my_robot_basics.checks.relays import relay_endpoints, relays
from my_robot_basics.checks.topics import topic_endpoints
from my_robot_basics.checks.topics.latched import LATCHED
from nodes.running import running
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)
from relaying import check_delivery, check_late_joiner, monitor, pose
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from my_robot_basics import live

RELIABLE, BEST_EFFORT = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
VOLATILE, TRANSIENT_LOCAL = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
PROFILES = {
    f'{reliability.name} {durability.name}': QoSProfile(
        depth=1, reliability=reliability, durability=durability
    )
    for reliability in (RELIABLE, BEST_EFFORT)
    for durability in (VOLATILE, TRANSIENT_LOCAL)
}


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(relay_endpoints, 'TIMEOUT_SEC', 1.0)
    monkeypatch.setattr(relays, 'LOST_SEC', 1.0)
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 1.0)


@pytest.mark.parametrize('offered', PROFILES.values(), ids=PROFILES)
def test_a_monitor_passes_silently_with_any_offered_qos_profile(run, capfd, offered):
    run(monitor.JointStateMonitor, monitor=offered)
    capfd.readouterr()
    check_delivery()
    check_late_joiner()
    assert capfd.readouterr() == ('', '')


@pytest.mark.slow
def test_a_monitor_in_a_process_of_its_own_passes():
    with running('joint_state_monitor'):
        check_delivery()
        check_late_joiner()


@pytest.mark.slow
def test_a_monitor_passes_beside_other_nodes_on_its_topics(run):
    talker = run(Node, 'talker')
    sensor = talker.create_publisher(JointState, '/sensor/joint_states', qos_profile_sensor_data)
    latched = talker.create_publisher(String, '/arm_description', LATCHED)
    latched.publish(String(data='the one of the lesson'))
    talker.create_timer(0.005, lambda: sensor.publish(JointState(name=['joint2'])))
    talker.create_subscription(JointState, '/sensor/joint_states', lambda _: None, 10)
    run(monitor.JointStateMonitor)
    check_delivery()
    check_late_joiner()


class Looks(monitor.JointStateMonitor):
    """Subscribes once there is a publisher, with the QoS that it offers."""

    def asked(self, offered):
        return QoSProfile(depth=10, reliability=offered.reliability, durability=offered.durability)

    def pass_on(self, type_, source, to, asked, offered):
        publisher = self.create_publisher(type_, to, offered)

        def look():
            for offer in self.get_publishers_info_by_topic(source):
                profile = self.asked(offer.qos_profile)
                self.create_subscription(type_, source, publisher.publish, profile)
                timer.cancel()
                break

        timer = self.create_timer(0.05, look)


class LooksAtHalf(Looks):
    def asked(self, offered):
        return QoSProfile(depth=10, reliability=offered.reliability)


def test_a_monitor_that_copies_the_publishers_qos_profile_passes(run):
    run(Looks)
    check_delivery()
    check_late_joiner()


@pytest.mark.slow
def test_a_monitor_that_copies_only_the_reliability_fails_as_a_late_joiner(run):
    run(LooksAtHalf)
    for _ in range(3):
        with pytest.raises(CheckFailed, match='TRANSIENT_LOCAL, saw VOLATILE: request'):
            check_late_joiner()


@pytest.mark.slow
def test_a_publisher_created_only_upon_a_message_fails(run, impatient):
    class Lazy(monitor.JointStateMonitor):
        def pass_on(self, type_, source, to, asked, offered):
            def receive(message):
                self.create_publisher(type_, to, offered).publish(message)

            self.create_subscription(type_, source, receive, asked)

    run(Lazy)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(
            CheckFailed, match=r'saw none: /joint_state_monitor subscribes to .*yet'
        ):
            check()


class Changes(monitor.JointStateMonitor):
    """Publishes another message instead of the JointState."""

    def changed(self, publish):
        return lambda message: publish(
            self.other(message) if isinstance(message, JointState) else message
        )


class Stamps(Changes):
    def other(self, message):
        message.header.stamp = self.get_clock().now().to_msg()
        return message


class OneFrame(Changes):
    def other(self, message):
        message.header.frame_id = 'base_link'
        return message


class DropsHeader(Changes):
    def other(self, message):
        return JointState(
            name=message.name,
            position=message.position,
            velocity=message.velocity,
            effort=message.effort,
        )


class DropsVelocity(Changes):
    def other(self, message):
        message.velocity = []
        return message


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'field'),
    [
        (Stamps, r'header\.stamp'),
        (OneFrame, r'header\.frame_id'),
        (DropsHeader, 'header'),
        (DropsVelocity, 'velocity'),
    ],
)
def test_a_message_with_a_changed_field_fails_and_the_field_is_named(
    run, impatient, node_class, field
):
    run(node_class)
    with pytest.raises(CheckFailed, match=f'publish exactly .*; not the same: {field}$'):
        check_delivery()
    check_late_joiner()


@pytest.mark.slow
def test_fields_that_a_task_does_not_name_may_change(run, impatient):
    class Renames(Changes):
        def other(self, message):
            return JointState(name=['elbow'], position=message.position)

    class Rebuilds(Changes):
        def other(self, message):
            return JointState(name=message.name, position=message.position)

    kept = relay('/sensor/joint_states', to='/monitor/joint_states', fields=['name', 'position'])
    run(Rebuilds)
    kept.assert_carries(pose, qos_profile=qos_profile_sensor_data)
    live.stop()
    run(Stamps)
    kept.assert_carries(pose, qos_profile=qos_profile_sensor_data)
    live.stop()
    run(Renames)
    with pytest.raises(CheckFailed, match=r'not the same: name$'):
        kept.assert_carries(pose, qos_profile=qos_profile_sensor_data)


@pytest.mark.slow
def test_invented_messages_fail(run):
    class Invents(monitor.JointStateMonitor):
        def __init__(self):
            super().__init__()
            invented = JointState(name=['joint1'], position=[0.5])
            publisher = next(p for p in self.publishers if p.topic == '/monitor/joint_states')
            self.create_timer(0.1, lambda: publisher.publish(invented))

    run(Invents)
    with pytest.raises(
        CheckFailed, match='messages that nobody published on /sensor/joint_states'
    ):
        check_delivery()


@pytest.mark.slow
@pytest.mark.parametrize(
    ('asked', 'reason'),
    [
        (10, r'saw RELIABLE/VOLATILE \(incompatible: RELIABILITY\): give create_subscription'),
        (PROFILES['BEST_EFFORT TRANSIENT_LOCAL'], r'LOCAL \(incompatible: DURABILITY\)'),
        (
            QoSProfile(depth=1, reliability=BEST_EFFORT, deadline=Duration(seconds=1)),
            r'saw BEST_EFFORT/VOLATILE \(incompatible: DEADLINE\): the publisher offers',
        ),
    ],
)
def test_a_subscription_with_an_incompatible_qos_profile_is_named(run, asked, reason):
    run(monitor.JointStateMonitor, sensor=asked)
    with pytest.raises(CheckFailed, match=reason):
        check_delivery()


@pytest.mark.slow
@pytest.mark.parametrize('reliability', [RELIABLE, BEST_EFFORT])
def test_a_volatile_subscription_is_named(run, reliability):
    run(monitor.JointStateMonitor, description=QoSProfile(depth=10, reliability=reliability))
    with pytest.raises(CheckFailed, match='TRANSIENT_LOCAL, saw VOLATILE: request'):
        check_late_joiner()


@pytest.mark.slow
def test_a_requested_deadline_that_no_publisher_offers_is_named(run, impatient):
    asked = QoSProfile(
        depth=1,
        reliability=RELIABLE,
        durability=TRANSIENT_LOCAL,
        deadline=Duration(seconds=1),
    )
    run(monitor.JointStateMonitor, description=asked)
    with pytest.raises(CheckFailed, match='the publisher offers no deadline, so leave that'):
        check_late_joiner()


@pytest.mark.slow
def test_a_best_effort_subscription_fails_as_a_late_joiner(run, impatient):
    run(monitor.JointStateMonitor, description=PROFILES['BEST_EFFORT TRANSIENT_LOCAL'])
    with pytest.raises(CheckFailed, match='request RELIABLE, too: only then'):
        check_late_joiner()


def test_a_message_replaced_by_an_empty_one_fails(run, impatient):
    class Constant(monitor.JointStateMonitor):
        def changed(self, publish):
            return lambda message: publish(type(message)())

    run(Constant)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(CheckFailed, match='only others in 1 s: publish exactly the message'):
            check()


@pytest.mark.slow
def test_a_callback_that_publishes_nothing_does_not_pass(run, impatient):
    class Silent(monitor.JointStateMonitor):
        def changed(self, publish):
            return lambda message: None

    run(Silent)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(CheckFailed, match='saw none in 1 s: see that your node spins'):
            check()


@pytest.mark.slow
def test_subscriptions_with_every_qos_profile_at_once_fail(run):
    class Everything(monitor.JointStateMonitor):
        def pass_on(self, type_, source, to, asked, offered):
            publisher = self.create_publisher(type_, to, offered)
            for each in PROFILES.values():
                self.create_subscription(type_, source, publisher.publish, each)

    run(Everything)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(
            CheckFailed, match=r'saw BEST_EFFORT/TRANSIENT_LOCAL and .* choose one'
        ):
            check()


def test_the_wrong_topics_are_named(run, impatient):
    class NoEars(Node):
        def __init__(self):
            super().__init__('no_ears')
            self.create_publisher(JointState, '/monitor/joint_states', 10)
            self.create_publisher(JointState, '/monitor/arm_description', 10)
            self.create_subscription(JointState, '/sensors/joint_states', print, 10)

    run(NoEars)
    with pytest.raises(CheckFailed, match='saw none in 1 s: /no_ears uses /sensors/joint_states'):
        check_delivery()
    with pytest.raises(CheckFailed, match='String messages on /monitor/arm_description, saw Join'):
        check_late_joiner()
    with pytest.raises(CheckFailed, match='a publisher on /monitor/joint_state, saw none in 1 s'):
        relay('/sensor/joint_states', to='/monitor/joint_state').assert_carries(
            pose, qos_profile=qos_profile_sensor_data
        )


@pytest.mark.slow
def test_a_failure_names_the_monitor_and_not_the_publishing_node(run):
    arm = run(Node, 'arm', key='arm')
    arm.create_publisher(JointState, '/sensor/joint_states', 10)
    run(Node, 'joint_state_monitor', key='monitor')
    with pytest.raises(CheckFailed, match=r'saw none.*: /joint_state_monitor runs, so look'):
        check_delivery()
