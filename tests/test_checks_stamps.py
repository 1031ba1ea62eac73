"""Stamps of the node's clock and of the computer's are distinguished in every recording."""

import pytest
from my_robot_basics.checks import CheckFailed, topic
from my_robot_basics.checks.clock import own_clock
from my_robot_basics.checks.clock.clock import Inconclusive
from my_robot_basics.checks.clock.own_clock import _ahead_sec
from my_robot_basics.checks.recordings.recorded_messages import Sample
from my_robot_basics.checks.recordings.recording import Recording
from my_robot_basics.feedback.errors import Starved
from nodes.running import imported, running
from rclpy.time import Time
from sensor_msgs.msg import JointState

from my_robot_basics import live

TOPIC = '/kinematics/joint_states'
COMPUTER = "saw the computer's clock: set message.header.stamp = self.get_clock"

FiveHz = imported('five_hz').FiveHz
SteadyClock = imported('steady_clock').SteadyClock
NoParameterServices = imported('no_parameter_services').NoParameterServices
WallStamp = imported('wall_stamp').WallStamp


class SteadyWallStamp(WallStamp, SteadyClock):
    pass


class UnmovableWallStamp(WallStamp, NoParameterServices):
    pass


@pytest.fixture
def run(patient):
    yield live.run
    live.stop()


@pytest.mark.parametrize(
    ('node_class', 'clock'),
    [(WallStamp, 'simulated'), (SteadyWallStamp, 'wall'), (UnmovableWallStamp, 'wall')],
)
def test_stamps_of_the_computers_clock_fail_on_either_clock(run, node_class, clock):
    run(node_class)
    recording = topic(TOPIC).record(seconds=10.0)
    assert recording.clock == clock
    with pytest.raises(CheckFailed, match=COMPUTER):
        recording.assert_stamps()


@pytest.mark.parametrize(
    'node_class',
    [SteadyClock, NoParameterServices],
)
def test_stamps_of_the_nodes_clock_pass_and_use_sim_time_is_reset(run, node_class):
    node = run(node_class)
    recording = topic(TOPIC).record(seconds=10.0)
    assert recording.clock == 'wall'
    recording.assert_stamps()
    # no trace: the node is on its own clock again, and alive
    assert node.get_parameter('use_sim_time').value is False
    topic(TOPIC).wait_for(timeout_sec=5.0)


@pytest.mark.slow
def test_stamps_pass_if_the_nodes_clock_cannot_be_changed(patient):
    with running('no_parameter_services'):
        topic(TOPIC).record(seconds=10.0).assert_stamps()


@pytest.mark.parametrize(
    ('looks', 'passes'),
    [
        ([[4.9, 4.9]], True),
        ([[0.1, 4.9]], True),
        ([[0.1, 0.1]], False),
        # the node's clock stands at 0: it has not got the time yet
        ([[-1.7e9, -1.7e9]], True),
        # nothing was published meanwhile
        ([[]], True),
        # the clock could not be driven, at first or at all
        ([None, None, [0.1]], False),
        ([None, None, None], True),
    ],
)
def test_a_node_fails_only_if_each_stamp_stays_behind_the_advanced_clock(
    monkeypatch, looks, passes
):
    left = list(looks)

    def look(*args):
        ahead = left.pop(0)
        if ahead is None:
            raise Inconclusive('a node did not answer in time')
        return ahead

    monkeypatch.setattr(own_clock, '_while_ahead', look)
    if passes:
        own_clock.expect_to_follow(TOPIC, JointState, ['/a'])
    else:
        with pytest.raises(CheckFailed, match=COMPUTER):
            own_clock.expect_to_follow(TOPIC, JointState, ['/a'])
    assert left == []


def recorded(samples, **options):
    """What was recorded in four seconds."""
    return Recording(
        topic_name=TOPIC, messages=tuple(samples), publishers=('/a',), seconds=4.0, **options
    )


@pytest.mark.parametrize(
    ('apart_sec', 'told'),
    [
        # a busy machine parts the two messages of one callback
        ([0.001, 0.001, 0.1, 0.001], 'two messages at once with the same stamp'),
        ([0.2, 0.2, 0.2, 0.001], 'a stamp that does not advance'),
    ],
)
def test_a_stamp_used_twice_is_distinguished_from_a_stamp_that_stays(apart_sec, told):
    samples = []
    for number, between_sec in enumerate(apart_sec):
        message = JointState()
        message.header.stamp.sec = 1 + number
        samples += [Sample(message, number, number)]
        samples += [Sample(message, number + between_sec, number + between_sec)]
    with pytest.raises(CheckFailed, match=told):
        recorded(samples, clock='wall', start_sec=0.0).assert_stamps()


@pytest.mark.parametrize('is_another', [True, False])
def test_messages_of_one_tick_may_share_a_stamp_unless_they_are_equal(is_another):
    samples = []
    for number in range(1, 5):
        for position in (0.1, 0.2) if is_another else (0.1, 0.1):
            message = JointState(position=[position])
            message.header.stamp.sec = 100 + number
            samples.append(Sample(message, float(number), 1.7e9 + number))
    made = recorded(samples, clock='simulated', start_sec=100.0)
    if is_another:
        made.assert_stamps()
    else:
        with pytest.raises(CheckFailed, match='two messages at once with the same stamp'):
            made.assert_stamps()


def test_a_stamp_that_stays_over_several_ticks_fails():
    samples = []
    for number in range(1, 5):
        message = JointState(position=[0.1 * number])
        message.header.stamp.sec = 101
        samples.append(Sample(message, 1.0 + number / 10, 1.7e9 + number))
    with pytest.raises(CheckFailed, match='a stamp that does not advance'):
        recorded(samples, clock='simulated', start_sec=100.0).assert_stamps()


def test_the_computers_clock_is_named_even_if_one_message_comes_late():
    samples = []
    for number in range(1, 21):
        at_sec = 100.0 + 0.01 * number  # of wall time; the robot's goes twenty times as fast
        message = JointState()
        message.header.stamp = Time(seconds=at_sec).to_msg()
        samples.append(Sample(message, 0.2 * number, at_sec + 0.3 * (number == 20)))
    with pytest.raises(CheckFailed, match=COMPUTER):
        recorded(samples, clock='simulated', start_sec=100.0).assert_stamps()


def test_stamps_a_nanosecond_apart_count_as_advancing():
    samples = []
    for number in range(1, 5):
        message = JointState()
        message.header.stamp.sec, message.header.stamp.nanosec = 1_800_000_000, number
        samples.append(Sample(message, 0.2 * number, 1_800_000_000.0 + 0.2 * number))
    with pytest.raises(CheckFailed, match=r'a stamp 0.6 s behind it'):
        recorded(samples, clock='simulated', start_sec=1_800_000_000.0).assert_stamps()


@pytest.mark.parametrize(
    ('off_sec', 'was_busy', 'raised'),
    [
        ([2.0] * 20, True, CheckFailed),
        ([0.0] * 19 + [2.0], True, Starved),
        ([0.0] * 19 + [2.0], False, CheckFailed),
    ],
)
def test_one_late_stamp_on_a_busy_machine_counts_as_starved(off_sec, was_busy, raised):
    samples = []
    for number, off in enumerate(off_sec, start=1):
        at_sec = 1_000.0 + 0.2 * number + off
        message = JointState()
        message.header.stamp = Time(seconds=at_sec - off).to_msg()
        samples.append(Sample(message, at_sec - 1_000.0, at_sec))
    made = recorded(samples, clock='wall', start_sec=1_000.0, was_busy=was_busy)
    with pytest.raises(CheckFailed, match=r'a stamp 2\.0 s behind it') as failed:
        made.assert_stamps()
    assert failed.type is raised


def test_stamps_of_a_clock_that_stands_still_are_not_taken_for_wall_time():
    shown_ns = [100 * 10**9, 105 * 10**9]
    by_way_of_a_float = 105 * 10**9 + 300
    stood = [(105 * 10**9, sent * 10**8) for sent in (1040, 1048, 1050)]
    assert _ahead_sec([*stood, (by_way_of_a_float, 104 * 10**9)], shown_ns) == []
    assert _ahead_sec([(104 * 10**9 + 5000, 104 * 10**9)], shown_ns) == [5e-6]


def test_a_node_that_refuses_use_sim_time_passes_with_its_own_stamps(patient):
    with running('refuses_parameters'):
        recording = topic(TOPIC).record(seconds=10.0)
        recording.assert_stamps()
    assert recording.clock == 'wall'
