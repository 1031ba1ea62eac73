"""Each planted fault is reported first; its fix, applied literally, lets messages arrive."""

import contextlib
import shlex
import subprocess
import sys

import pytest
from diagnosed import wait_for, wait_for_finding
from my_robot_basics.doctor import looking
from my_robot_basics.doctor.diagnosing import diagnose
from my_robot_basics.live import run, stop
from my_robot_basics.session import classroom
from nodes.patient import (
    CONVERT,
    LISTENER,
    PUBLISHER,
    RECEIVE,
    SEND,
    SPIN,
    STAMP,
    SUBSCRIPTION,
    TALKER,
    TIMER,
    TOPIC,
    node_class,
    process,
    program,
)
from rclpy.parameter import Parameter

DEAD = 'while rclpy.ok(): time.sleep(0.1)'


@pytest.fixture(autouse=True)
def _brief_looks(monkeypatch):
    monkeypatch.setattr(looking, 'ENOUGH_SEC', 0.5)
    yield
    stop()


def first_finding(**options):
    (diagnosis,) = diagnose(TOPIC, domain_id=classroom.enter(), **options)
    assert diagnosis.findings, 'nothing was found'
    return diagnosis.findings[0]


def assert_well(listener):
    before = len(listener.heard)
    assert wait_for(lambda: len(listener.heard) > before)
    assert diagnose(TOPIC, domain_id=classroom.enter())[0].findings == ()


def named(name):
    return PUBLISHER.replace(TOPIC, name)


FAULTS = {
    # what is planted: the node's source, the line, what stands there instead, the title
    'publishes elsewhere': (TALKER, PUBLISHER, named('/odometry'), 'no publisher'),
    'does not subscribe': (LISTENER, SUBSCRIPTION, 'pass', 'no subscription'),
    'misspelt': (TALKER, PUBLISHER, named('/kinematic/joint_state'), 'the spelling differs'),
    'case': (TALKER, PUBLISHER, named('/kinematics/Joint_States'), 'upper and lower case differ'),
    'slash': (TALKER, PUBLISHER, named('/kinematics_/joint/states'), 'similar name'),
    'no slash': (TALKER, PUBLISHER, named('/kinematicsjoint_states'), 'the slashes differ'),
    'namespace': (TALKER, PUBLISHER, named('/joint_states'), 'the namespace differs'),
    'listener misspelt': (
        LISTENER,
        SUBSCRIPTION,
        SUBSCRIPTION.replace(TOPIC, '/kinematics/join_states'),
        'the spelling differs',
    ),
    'best effort': (
        TALKER,
        PUBLISHER,
        PUBLISHER.replace('10', 'QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)'),
        'QoS incompatible: RELIABILITY',
    ),
    'wants the past': (
        LISTENER,
        SUBSCRIPTION,
        SUBSCRIPTION.replace(
            '10', 'QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
        ),
        'QoS incompatible: DURABILITY',
    ),
    'wants a deadline': (
        LISTENER,
        SUBSCRIPTION,
        SUBSCRIPTION.replace('10', 'QoSProfile(depth=10, deadline=Duration(seconds=1))'),
        'QoS incompatible: DEADLINE',
    ),
    'no timer': (TALKER, TIMER, 'pass', 'the timer never fires'),
    'timer in milliseconds': (
        TALKER,
        TIMER,
        TIMER.replace('0.2', '200'),
        'the timer never fires',
    ),
    'no stamp': (TALKER, STAMP, 'pass', 'stamps missing or old'),
    'old stamp': (TALKER, STAMP, f'{STAMP}; message.header.stamp.sec -= 5', 'stamps missing'),
    'degrees': (TALKER, CONVERT, 'pass', 'degrees instead of radians'),
}


@pytest.mark.parametrize('fault', FAULTS)
def test_a_planted_fault_in_a_line_is_reported_first_and_fixed(fault):
    source, line, wrong, title = FAULTS[fault]
    edits = {TALKER: [], LISTENER: []}
    edits[source] = [(line, wrong)]
    run(node_class(TALKER, *edits[TALKER]))
    run(node_class(LISTENER, *edits[LISTENER]))
    found = first_finding(seconds=1.5)
    assert title in found.title
    if found.code.startswith('self.subscription'):
        # whichever end was planted: the fix may be for the other one
        source, line = LISTENER, SUBSCRIPTION
        run(node_class(TALKER, *edits[TALKER]))
        listener = run(node_class(LISTENER, (SUBSCRIPTION, found.code)))
    else:
        run(node_class(TALKER, (line, found.code)))
        listener = run(node_class(LISTENER))
    assert_well(listener)


@pytest.mark.slow
def test_sim_time_without_a_clock_is_reported_and_its_fix_works():
    run(node_class(TALKER), parameter_overrides=[Parameter('use_sim_time', value=True)])
    listener = run(node_class(LISTENER))
    found = first_finding(seconds=2.0)
    assert found.title == 'use_sim_time without a /clock'
    words = shlex.split(found.code)
    assert words[:2] == ['$', 'ros2']
    main = 'import sys; from my_robot_basics.ros2.main import main; sys.exit(main())'
    subprocess.run([sys.executable, '-c', main, *words[2:]], check=True, stdout=subprocess.DEVNULL)
    assert_well(listener)


@pytest.mark.slow
def test_a_publisher_that_is_not_spun_is_reported_and_its_fix_works():
    listener = run(node_class(LISTENER))
    with process(program(TALKER, (SPIN, DEAD))):
        found = wait_for_finding(first_finding, 'the node is not spinning', seconds=2.0)
    with process(program(TALKER, (SPIN, found.code))):
        assert wait_for(lambda: listener.heard)


@pytest.mark.slow
def test_two_types_on_a_topic_are_reported_and_the_fix_works():
    # in one process rclpy itself refuses the second one
    other = SUBSCRIPTION.replace('JointState,', 'Point,')
    run(node_class(LISTENER, (SUBSCRIPTION, other)))
    with process(program(TALKER)):
        found = wait_for_finding(first_finding, 'types differ')
        listener = run(node_class(LISTENER, (SUBSCRIPTION, found.code)))
        assert_well(listener)


@pytest.mark.slow
def test_a_message_type_that_is_not_installed_is_reported(monkeypatch):
    listener = run(node_class(LISTENER))
    with process(program(TALKER)):
        assert wait_for(lambda: listener.heard)
        assert diagnose(TOPIC, domain_id=classroom.enter())[0].findings == ()
        # as for somebody whose environment lacks the package
        monkeypatch.setitem(sys.modules, 'sensor_msgs.msg', None)
        found = first_finding()
        assert found.title == 'message type not installed here'
        assert 'sensor_msgs/msg/JointState' in found.expected
        assert 'the package sensor_msgs ' in found.fix


@pytest.mark.slow
def test_a_subscription_that_is_not_spun_is_reported_and_its_fix_works(tmp_path):
    run(node_class(TALKER))
    note = tmp_path / 'heard'
    write = (RECEIVE, f"open({str(note)!r}, 'w').close()")
    with process(program(LISTENER, write, (SPIN, DEAD))):
        found = wait_for_finding(first_finding, 'the node is not spinning')
    assert not note.exists()
    with process(program(LISTENER, write, (SPIN, found.code))):
        assert wait_for(note.exists)


@pytest.mark.slow
def test_a_late_joiner_that_missed_a_latched_message_is_reported_and_fixed():
    latched = PUBLISHER.replace(
        '10', 'QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)'
    )
    run(node_class(TALKER, (PUBLISHER, latched), (TIMER, 'self.publish()')))
    listener = run(node_class(LISTENER))
    found = first_finding(seconds=1.0)
    assert found.title == 'joined too late'
    assert not listener.heard
    listener = run(node_class(LISTENER, (SUBSCRIPTION, found.code)))
    assert wait_for(lambda: listener.heard)
    assert diagnose(TOPIC, domain_id=classroom.enter(), seconds=1.0)[0].findings == ()


@pytest.mark.slow
def test_a_queue_that_is_shorter_than_a_burst_is_reported_and_its_fix_works(monkeypatch):
    monkeypatch.setattr(looking, 'ENOUGH_SEC', 2.5)
    burst = f"[{SEND} for message.header.frame_id in '{'a' * 40}']"
    run(
        node_class(
            TALKER,
            (SEND, burst),
            (PUBLISHER, PUBLISHER.replace('10', '100')),
            (TIMER, TIMER.replace('0.2', '1.0')),
        )
    )
    slow = (RECEIVE, f'{RECEIVE}; time.sleep(0.01)')
    listener = run(node_class(LISTENER, slow))
    found = first_finding()
    assert found.title == 'messages lost to a short queue'
    assert wait_for(lambda: len(stamps(listener)) > 2)
    assert min(stamps(listener).values()) < 40
    listener = run(node_class(LISTENER, slow, (SUBSCRIPTION, found.code)))
    assert wait_for(lambda: len(stamps(listener)) > 2)
    # the last burst may still be arriving
    assert set(list(stamps(listener).values())[:-1]) == {40}


def stamps(listener):
    """How many messages of each burst were received."""
    count = {}
    for message in tuple(listener.heard):
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        count[stamp] = count.get(stamp, 0) + 1
    return count


@pytest.mark.slow
def test_a_remapped_publisher_is_reported_and_its_fix_works():
    listener = run(node_class(LISTENER))
    command = program(TALKER, ('rclpy.init()', 'import sys; rclpy.init(args=sys.argv)'))
    with process([*command, '--ros-args', '-r', f'{TOPIC}:=/elsewhere']):
        found = wait_for_finding(first_finding, 'remapped')
    with process(shlex.split(found.code.removeprefix('$ '))):
        assert wait_for(lambda: listener.heard)


@pytest.mark.slow
@pytest.mark.parametrize(
    ('environment', 'title'),
    [
        ({'ROS_DOMAIN_ID': '{neighbour}'}, 'another domain ID'),
        ({'ROS_AUTOMATIC_DISCOVERY_RANGE': 'OFF'}, 'a process that cannot be discovered'),
    ],
)
def test_a_publisher_out_of_reach_is_reported_and_its_fix_works(environment, title):
    listener = run(node_class(LISTENER))
    with neighbouring_domain() as neighbour:
        wrong = {name: value.format(neighbour=neighbour) for name, value in environment.items()}
        with process(program(TALKER), **wrong):
            found = wait_for_finding(
                first_finding, title, other_domains='ROS_DOMAIN_ID' in environment
            )
        shell = f'{found.code.removeprefix("$ ")}; exec {shlex.join(program(TALKER))}'
        with process(['sh', '-c', shell], **wrong):
            assert wait_for(lambda: listener.heard)


@contextlib.contextmanager
def neighbouring_domain():
    from my_robot_basics.session import domain

    claim = domain.claim()
    yield claim.domain_id
    claim.release()
