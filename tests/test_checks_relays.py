"""A node that passes messages on is judged by what comes out, whatever its own QoS."""

import itertools
import time

import pytest
from my_robot_basics.checks import (
    CheckFailed,
    enough,
    passage,
    relay,
    relay_endpoints,
    relays,
    topic_endpoints,
)
from my_robot_basics.checks.latched import LATCHED
from nodes.running import imported, running
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)
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

monitor = imported('joint_state_monitor')
numbers = itertools.count()

joint_states = relay('/sensor/joint_states', to='/monitor/joint_states')
arm_description = relay('/arm_description', to='/monitor/arm_description')


@pytest.fixture
def run():
    yield live.run
    live.stop()


@pytest.fixture
def impatient(monkeypatch):
    monkeypatch.setattr(relay_endpoints, 'TIMEOUT_SEC', 1.0)
    monkeypatch.setattr(relays, 'LOST_SEC', 1.0)
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 1.0)


def description():
    return String(data=f'an arm with {next(numbers)} joints')


def pose():
    return JointState(name=['joint1'], position=[float(next(numbers) % 1000 + 1)])


def check_delivery():
    joint_states.assert_carries(pose, qos_profile=qos_profile_sensor_data)


def check_late_joiner():
    arm_description.assert_carries_latched(description, times=3)


@pytest.mark.parametrize('offered', PROFILES.values(), ids=PROFILES)
def test_a_monitor_passes_whatever_it_offers_and_nothing_is_said(run, capfd, offered):
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
def test_other_nodes_on_the_topics_are_no_hindrance(run):
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
    """Subscribes once there is a publisher, and asks for what that offers."""

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


def test_who_looks_for_publishers_first_may_ask_for_what_they_offer(run):
    run(Looks)
    check_delivery()
    check_late_joiner()


@pytest.mark.slow
def test_who_looks_for_publishers_and_does_not_ask_for_what_was_said_is_named(run):
    run(LooksAtHalf)
    for _ in range(3):
        with pytest.raises(CheckFailed, match='TRANSIENT_LOCAL, saw VOLATILE: request'):
            check_late_joiner()


@pytest.mark.slow
def test_a_publisher_that_waits_for_a_message_is_too_late(run, impatient):
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
    """Publishes another message in place of a JointState."""

    def changed(self, publish):
        return lambda message: publish(
            self.other(message) if isinstance(message, JointState) else message
        )


class Stamps(Changes):
    def other(self, message):
        message.header.stamp = self.get_clock().now().to_msg()
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
    [(Stamps, 'header'), (DropsHeader, 'header'), (DropsVelocity, 'velocity')],
)
def test_a_message_of_which_a_field_was_changed_does_not_pass(run, impatient, node_class, field):
    run(node_class)
    with pytest.raises(CheckFailed, match=f'publish exactly .*; not the same: {field}$'):
        check_delivery()
    check_late_joiner()


@pytest.mark.slow
def test_fields_that_a_task_does_not_name_may_be_others(run, impatient):
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
def test_messages_that_nobody_sent_are_told(run):
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
def test_a_subscription_that_asks_for_too_much_is_named(run, asked, reason):
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
def test_a_promise_that_nobody_gives_is_named_to_a_late_joiner(run, impatient):
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
def test_best_effort_hears_nothing_of_what_was_said_before(run, impatient):
    run(monitor.JointStateMonitor, description=PROFILES['BEST_EFFORT TRANSIENT_LOCAL'])
    with pytest.raises(CheckFailed, match='request RELIABLE, too: only then'):
        check_late_joiner()


def test_a_message_that_was_changed_does_not_pass(run, impatient):
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


class Counts(monitor.JointStateMonitor):
    """Gives each callback the number of the message, and the messages so far."""

    def changed(self, publish):
        heard = []

        def receive(message):
            heard.append(message)
            for each in self.chosen(heard):
                publish(each)

        return receive


class DropsEverySecond(Counts):
    def chosen(self, heard):
        return heard[-1:] if len(heard) % 2 else []


class DropsEveryTenth(Counts):
    def chosen(self, heard):
        return heard[-1:] if len(heard) % 10 else []


class DropsEveryEleventh(Counts):
    def chosen(self, heard):
        return heard[-1:] if len(heard) % 11 else []


class DropsEveryHundredth(Counts):
    def chosen(self, heard):
        return heard[-1:] if len(heard) % 100 else []


class DropsEqualOnes(Counts):
    def chosen(self, heard):
        return heard[-1:] if heard[-1:] != heard[-2:-1] else []


class DropsZeros(Counts):
    def chosen(self, heard):
        return heard[-1:] if any(heard[-1].position) else []


class DropsNegativeOnes(Counts):
    def chosen(self, heard):
        return heard[-1:] if min(heard[-1].position) >= 0.0 else []


class DropsLargeOnes(Counts):
    def chosen(self, heard):
        return heard[-1:] if max(heard[-1].position) < 2000.0 else []


class DropsEmptyTexts(Counts):
    def chosen(self, heard):
        return heard[-1:] if heard[-1].data else []


class DropsWhatComesSoon(Counts):
    def chosen(self, heard):
        now, before = time.monotonic(), getattr(self, 'before', 0.0)
        if now - before < 0.2:
            return []
        self.before = now
        return heard[-1:]


class DropsAfterAPause(Counts):
    def chosen(self, heard):
        now, before = time.monotonic(), getattr(self, 'before', 0.0)
        self.before = now
        return heard[-1:] if now - before < 1.0 else []


class Lags(Counts):
    def chosen(self, heard):
        return heard[-2:-1]


class Doubles(Counts):
    def chosen(self, heard):
        return heard[-1:] * 2


class SwapsPairs(Counts):
    def chosen(self, heard):
        return [] if len(heard) % 2 else heard[:-3:-1]


@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (DropsEverySecond, 'saw messages that are not republished: publish in every call'),
        (DropsEveryTenth, 'saw messages that are not republished: publish in every call'),
        (DropsEveryEleventh, 'saw messages that are not republished: publish in every call'),
        (DropsEqualOnes, 'not republished: those equal to the one before: publish in every call'),
        (DropsZeros, 'not republished: those with zeros, or empty: publish in every call'),
        (DropsNegativeOnes, 'not republished: those with negative numbers: publish in every call'),
        (DropsLargeOnes, 'not republished: those with large numbers: publish in every call'),
        (DropsWhatComesSoon, 'saw messages that are not republished'),
        (DropsAfterAPause, 'not republished when it is the first after a pause: publish'),
        (Lags, 'is republished only when the next one arrives: publish the message'),
        (SwapsPairs, 'saw a message that is republished only when the next one arrives'),
        (Doubles, 'a message that is republished 2 times: subscribe once'),
    ],
)
def test_each_message_comes_out_at_once_and_once(run, node_class, reason):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_delivery()


class RaisesEachSecond(Counts):
    def chosen(self, heard):
        if len(heard) % 2 == 0:
            raise ValueError('an even number')
        return heard[-1:]


class RaisesOnceAfterwards(monitor.JointStateMonitor):
    def changed(self, publish):
        heard = []

        def receive(message):
            publish(message)
            heard.append(message)
            if len(heard) == 7:
                raise ValueError('the seventh')

        return receive


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (RaisesEachSecond, 'its callback raised ValueError: an even number .*fix that first'),
        (RaisesOnceAfterwards, 'its callback raised ValueError: the seventh .*fix that first'),
    ],
)
def test_a_callback_that_raised_is_named(run, node_class, reason):
    run(node_class)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(CheckFailed, match=reason):
            check()


class DestroysItself(monitor.JointStateMonitor):
    def changed(self, publish):
        heard = []

        def receive(message):
            publish(message)
            heard.append(message)
            if len(heard) == 3:
                self.destroy_node()

        return receive


class StandsStill(monitor.JointStateMonitor):
    def changed(self, publish):
        def receive(message):
            publish(message)
            time.sleep(15.0)

        return receive


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (DestroysItself, r'the node has ended: leave .* destroy_node\(\)'),
        (StandsStill, r'its callback has not returned \(line \d+: time\.sleep'),
    ],
)
def test_a_node_that_stops_between_two_messages_is_told_why(run, node_class, reason):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_delivery()


class LeavesOutTheFirstHundred(monitor.JointStateMonitor):
    def changed(self, publish):
        heard = []

        def receive(message):
            heard.append(message)
            if len(heard) > 100:
                publish(message)

        return receive


@pytest.mark.slow
@pytest.mark.timeout(120)
def test_no_first_hundred_may_be_left_out_however_long_that_takes(run, monkeypatch):
    turns = range(1, 201)  # of a machine that is busy all the time
    monkeypatch.setattr(relays, 'free_turns', lambda free_sec: iter(turns))
    run(LeavesOutTheFirstHundred)
    with pytest.raises(CheckFailed, match='to be republished on /monitor/joint_states, unchanged'):
        check_delivery()


@pytest.mark.slow
@pytest.mark.timeout(120)
def test_a_message_at_which_a_callback_raised_is_not_waited_for(run, monkeypatch):
    class Raises(monitor.JointStateMonitor):
        def changed(self, publish):
            def receive(message):
                raise ValueError('at each')

            return receive

    monkeypatch.setattr(relays, 'LOST_SEC', 3600.0)
    run(Raises)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(CheckFailed, match='saw none in 1 s: its callback raised ValueError'):
            check()


@pytest.mark.slow
def test_what_a_callback_raised_before_the_check_is_not_of_the_other_topic(run):
    class Raises(monitor.JointStateMonitor):
        def changed(self, publish):
            def receive(message):
                if isinstance(message, JointState):
                    raise ValueError('no pose')
                publish(message)

            return receive

    run(Raises)
    with pytest.raises(CheckFailed, match='its callback raised ValueError: no pose'):
        check_delivery()
    check_late_joiner()


@pytest.fixture
def leisurely(monkeypatch):
    monkeypatch.setattr(enough, 'SOME_SEC', 60.0)
    monkeypatch.setattr(passage, 'MOST_SEC', 60.0)


@pytest.mark.slow
@pytest.mark.usefixtures('leisurely')
def test_every_hundredth_message_is_missed_where_the_machine_is_quick(run):
    run(DropsEveryHundredth)
    with pytest.raises(CheckFailed, match='saw messages that are not republished'):
        check_delivery()


@pytest.mark.slow
@pytest.mark.parametrize('node_class', [DropsEverySecond, DropsEveryEleventh])
def test_where_no_time_is_left_a_few_messages_tell(run, monkeypatch, node_class):
    monkeypatch.setattr(enough, 'SOME_SEC', 0.0)
    monkeypatch.setattr(enough, 'LONG_SEC', 0.0)
    run(node_class)
    with pytest.raises(CheckFailed, match='saw messages that are not republished'):
        check_delivery()


@pytest.mark.slow
def test_without_time_a_right_node_passes(run, monkeypatch):
    monkeypatch.setattr(enough, 'SOME_SEC', 0.0)
    monkeypatch.setattr(enough, 'LONG_SEC', 0.0)
    monkeypatch.setattr(passage, 'MOST_SEC', 0.0)
    run(monitor.JointStateMonitor)
    check_delivery()


@pytest.mark.slow
def test_a_description_that_comes_out_twice_is_one_too_many(run):
    run(Doubles)
    with pytest.raises(CheckFailed, match='a message that is republished 2 times: subscribe once'):
        check_late_joiner()


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (DropsEqualOnes, 'not republished: those equal to the one before: publish in every call'),
        (DropsEmptyTexts, 'not republished: those with zeros, or empty: publish in every call'),
        (DropsEveryEleventh, 'saw messages that are not republished: publish in every call'),
    ],
)
def test_each_description_that_follows_comes_out_too(run, node_class, reason):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_late_joiner()


@pytest.mark.slow
def test_a_timer_that_has_only_the_latest_loses_one_of_two(run):
    class Latest(Counts):
        def __init__(self):
            self.latest = {}
            super().__init__()
            self.create_timer(0.1, self.flush)

        def changed(self, publish):
            return lambda message: self.latest.update({publish: message})

        def flush(self):
            while self.latest:
                publish, message = self.latest.popitem()
                publish(message)

    run(Latest)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(
            CheckFailed, match='saw two messages in quick succession of which only'
        ):
            check()


@pytest.mark.slow
def test_what_waits_for_a_timer_is_in_time(run):
    class Queues(Counts):
        def __init__(self):
            self.queue = []
            super().__init__()
            self.create_timer(0.1, self.flush)

        def changed(self, publish):
            return lambda message: self.queue.append((publish, message))

        def flush(self):
            while self.queue:
                publish, message = self.queue.pop(0)
                publish(message)

    run(Queues)
    check_delivery()
    check_late_joiner()


@pytest.mark.slow
def test_a_subscription_of_each_kind_is_no_choice(run):
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
def test_the_node_at_the_other_end_is_not_at_fault(run):
    arm = run(Node, 'arm', key='arm')
    arm.create_publisher(JointState, '/sensor/joint_states', 10)
    run(Node, 'joint_state_monitor', key='monitor')
    with pytest.raises(CheckFailed, match=r'saw none.*: /joint_state_monitor runs, so look'):
        check_delivery()
