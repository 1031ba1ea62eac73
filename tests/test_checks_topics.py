"""Topics from inside the student's kernel (nodes of live) and from outside; what silence means."""

import os
import subprocess
import sys
import threading
from functools import partial

import pytest
from geometry_msgs.msg import Point
from my_robot_basics.checks import CheckFailed, graph, student, topic
from my_robot_basics.checks.topics import topic_endpoints, wall_recording
from my_robot_basics.exchange import settled
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from nodes.running import imported, running
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

from my_robot_basics import live

TOPIC = '/kinematics/joint_states'
LIMITS = {'low': (-1.571, -2.095), 'high': (1.571, 2.095)}


pytestmark = pytest.mark.usefixtures('patient')


def check_messages(recording):
    recording.assert_joint_names(('joint1', 'joint2'))
    recording.assert_frame_id('base_link')
    recording.assert_stamps()
    recording.assert_positions_rad(**LIMITS, names=('joint1', 'joint2'))


@pytest.mark.parametrize(
    'node_class',
    [imported('five_hz').FiveHz, imported('swapped').SwappedNames],
)
def test_a_node_of_the_same_kernel_is_judged_exactly(run, capfd, node_class):
    node = run(node_class)
    capfd.readouterr()
    threads = threading.active_count()
    recording = topic(TOPIC).record(seconds=60.0)
    assert (recording.clock, len(recording.messages)) == ('simulated', 300)
    recording.assert_rate(hz=5.0)
    check_messages(recording)
    # no trace: nothing said, no thread left, the node on its own clock and alive
    assert capfd.readouterr().err == ''
    assert threading.active_count() == threads
    assert node.get_parameter('use_sim_time').value is False
    topic(TOPIC).wait_for(timeout_sec=5.0)


@pytest.mark.slow
def test_a_node_with_its_own_thread_and_context_is_judged_exactly():
    _, executor, thread = imported('own_thread').start()
    try:
        recording = topic(TOPIC).record(seconds=10.0)
    finally:
        executor.context.shutdown()
        thread.join()
    assert (recording.clock, len(recording.messages)) == ('simulated', 50)
    recording.assert_rate(hz=5.0)


@pytest.mark.slow
def test_a_second_node_that_never_spins_does_not_disturb_a_recording(run):
    run(imported('five_hz').FiveHz)
    silent = Node('bystander_that_never_spins', context=live.run(Node, 'spins').context)
    recording = topic(TOPIC).record(seconds=10.0)
    silent.destroy_node()
    assert (recording.clock, len(recording.messages)) == ('simulated', 50)


@pytest.mark.slow
def test_a_clock_publisher_of_the_student_leads_to_a_wall_recording(run):
    run(imported('five_hz').FiveHz)
    run(Node, 'my_simulator').create_publisher(Clock, '/clock', 10)
    recording = topic(TOPIC).record()
    assert recording.clock == 'wall'
    recording.assert_rate(hz=5.0)


@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (imported('degrees').Degrees, 'which looks like degrees: convert with math.radians'),
        (imported('no_stamp').NoStamp, 'saw a stamp of 0: set message.header.stamp'),
        (imported('one_stamp').OneStamp, 'saw a stamp that does not advance'),
        (imported('wall_stamp').WallStamp, "saw the computer's clock: set message.header.stamp"),
        (imported('wrong_names').WrongNames, "saw 'joint_1', 'joint_2'"),
    ],
)
def test_a_wrong_message_fails(run, node_class, reason):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_messages(topic(TOPIC).record(seconds=10.0))


@pytest.mark.slow
def test_stamps_of_a_node_that_ignores_the_clock_are_on_the_wall_clock(run):
    run(imported('steady_clock').SteadyClock)
    recording = topic(TOPIC).record()
    assert recording.clock == 'wall'
    check_messages(recording)


@pytest.mark.parametrize(
    ('node', 'reason'),
    [
        (
            'never_spins',
            '/kinematics_publisher has a publisher there and sends nothing, so see',
        ),
        ('callback_raises', 'no message in 4 s|none in 3 s'),
        ('wrong_topic', '/kinematics_publisher uses /kinematics/joint_state, so compare'),
    ],
)
def test_silence_is_explained(monkeypatch, capfd, node, reason):
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 3.0)
    # tests before have driven the clock ahead, and a node may wait for that time
    monkeypatch.setattr(wall_recording, 'ahead_sec', lambda: 0.0)
    with running(node), pytest.raises(CheckFailed, match=reason):
        topic(TOPIC).record()
    assert capfd.readouterr().err == ''


@pytest.mark.slow
def test_a_check_does_not_wait_for_a_node_whose_callback_raised(run):
    class Raises(Node):
        def __init__(self):
            super().__init__('raises')
            self.create_publisher(JointState, TOPIC, 10)
            self.create_timer(0.2, lambda: 1 / 0)

    run(Raises)
    with pytest.raises(CheckFailed, match=r'saw no message in 2 s: .* raised ZeroDivisionError'):
        topic(TOPIC).record()


@pytest.mark.slow
def test_malformed_messages_count_as_silence():
    # in a process of its own: rcl keeps the C library's complaint, and prints it later
    code = f"from my_robot_basics.checks import topic; topic('{TOPIC}').record()"
    here = {**os.environ, 'MY_ROBOT_BASICS_DOMAIN_ID': os.environ['ROS_DOMAIN_ID']}
    with running('garbage'):
        done = subprocess.run(
            [sys.executable, '-c', code], env=here, capture_output=True, text=True
        )
    assert 'CheckFailed: expected messages on /kinematics/joint_states, saw no mess' in done.stderr


def test_a_missing_node_is_reported(monkeypatch):
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 0.5)
    with pytest.raises(CheckFailed, match=r'saw none: the node is not running'):
        topic(TOPIC).record()


@pytest.mark.slow
@pytest.mark.parametrize(
    ('other', 'named'), [('other', '/kin.*, /other'), ('_other', '/_.*, /kin')]
)
def test_two_publishers_are_named(run, other, named):
    run(imported('five_hz').FiveHz)
    run(imported('five_hz').FiveHz, other, key='other')
    with pytest.raises(CheckFailed, match=rf'saw 2 \({named}\w*\): stop'):
        topic(TOPIC).record(seconds=1.0).assert_rate(hz=10.0)


@pytest.mark.slow
def test_two_types_on_a_topic_are_named(run):
    # within one participant Fast DDS itself refuses
    run(Node, 'other').create_publisher(Point, TOPIC, 10)
    with running('five_hz'):
        while len(graph().publishers(TOPIC)) < 2:
            pass
        with pytest.raises(CheckFailed, match='geometry_msgs/msg/Point and sensor_msgs/msg/Joint'):
            topic(TOPIC).record()


@pytest.mark.slow
def test_a_watcher_has_no_services_that_nodes_can_see(run):
    run(imported('five_hz').FiveHz)
    seen = set()

    class Spy(Node):
        def __init__(self):
            super().__init__('spy')
            self.create_timer(0.02, self.look)

        def look(self):
            seen.update(name for name, _ in self.get_service_names_and_types())

    run(Spy)
    topic(TOPIC).record(seconds=1.0)
    assert seen
    assert not [name for name in seen if '_check' in name]
    assert os.environ['ROS_DOMAIN_ID'] == str(live.classroom.enter())


@pytest.mark.starts
def test_the_notebook_is_not_asked_about_an_endpoint_that_is_on_the_graph(run, monkeypatch):
    asked = []
    monkeypatch.setattr(student, 'has_endpoint', lambda *args: not asked.append(args))
    run(Node, 'idle').create_subscription(JointState, TOPIC, print, 10)
    with Watcher() as watcher:
        sees = partial(graphs.subscription_infos, watcher.node, TOPIC)
        assert watcher.spin_until(lambda: bool(sees()), timeout_sec=10.0)
        for type_ in None, JointState, Point:
            assert topic(TOPIC).timeout_for(watcher, 9.0, end='subscriptions', type_=type_) == 9.0
        assert topic(TOPIC).timeout_for(watcher, 9.0, end='publishers') == 9.0
    assert asked == [
        (TOPIC, 'subscriptions', 'geometry_msgs/msg/Point'),
        (TOPIC, 'publishers', ''),
    ]


@pytest.mark.slow
def test_the_wait_is_short_if_the_notebook_reports_no_endpoint(run, monkeypatch):
    monkeypatch.setattr(topic_endpoints, 'ABSENT_SEC', 0.6)
    run(Node, 'idle').create_publisher(JointState, '/elsewhere', 10)
    assert student.has_endpoint('/elsewhere')
    assert not student.has_endpoint(TOPIC)
    with pytest.raises(CheckFailed, match=r'saw none( in 0\.6 s)?: /idle'):
        topic(TOPIC).record()


@pytest.mark.slow
def test_there_is_no_wait_if_no_endpoint_can_appear(run, monkeypatch):
    monkeypatch.setattr(topic_endpoints, 'ABSENT_SEC', 20.0)
    monkeypatch.setattr(topic_endpoints, 'PUBLISHER_SEC', 20.0)
    # pytest has threads and processes of its own
    for may_come in '_has_threads', '_has_processes', '_has_tasks', '_has_alarm':
        monkeypatch.setattr(settled, may_come, lambda: False)
    run(Node, 'idle').create_subscription(JointState, TOPIC, print, 10)
    with pytest.raises(CheckFailed, match=r'a publisher on .*, saw none: /idle is at the other'):
        topic(TOPIC).record()
    with pytest.raises(CheckFailed, match=r'a subscription on .*, saw none: one is there for sen'):
        topic(TOPIC).publish(Point(), timeout_sec=20.0)


@pytest.mark.parametrize('reply', ['', '{"failed":"no usable answer"}', '{"ok":1}', None])
def test_an_unusable_reply_counts_as_an_existing_endpoint(monkeypatch, reply):
    monkeypatch.setattr(student, 'send', lambda question: reply)
    assert student.has_endpoint(TOPIC)
