"""A check's own node among more endpoints than a lesson can have."""

import pytest
from grade_cell import grade_cell
from my_robot_basics.checks import CheckFailed, topic
from my_robot_basics.graph import graphs, watcher
from my_robot_basics.graph.rmw import LatchedSubscription
from my_robot_basics.graph.watcher import Watcher
from rclpy.node import Node
from std_msgs.msg import Empty, String

from my_robot_basics import live


@pytest.fixture
def node():
    yield live.run(Node, 'talker', key='talker')
    live.stop()


@pytest.mark.parametrize('spread', [True, False], ids=['on many topics', 'on one topic'])
def test_a_crowd_of_endpoints_fails_a_check(node, monkeypatch, spread):
    for number in range(80):
        node.create_publisher(Empty, f'/crowd/t{number if spread else 0}', 1)
    node.create_publisher(String, '/talk', 1)
    with Watcher() as here:
        assert graphs.wait_for_publisher(here, '/talk', timeout_sec=20.0)
        monkeypatch.setattr(watcher, 'MOST_ENDPOINTS', 80)
        with pytest.raises(CheckFailed, match=r'expected at most 80 nodes.*saw \d+: create'):
            here.spin_for(20.0)


def test_a_crowd_of_services_fails_a_check(node, monkeypatch):
    monkeypatch.setattr(watcher, 'MOST_ENDPOINTS', 2)
    with pytest.raises(CheckFailed, match='expected at most 2 nodes'):
        topic('/nowhere').wait_for()


def test_a_crowd_of_names_of_nodes_fails_a_check(node, monkeypatch):
    """A participant may announce as many as it likes, without an endpoint of any."""
    names = [(f'n{number}', '/') for number in range(watcher.MOST_ENDPOINTS)]
    monkeypatch.setattr(Node, 'get_node_names_and_namespaces', lambda self: names)
    with pytest.raises(CheckFailed, match='expected at most 1,000 nodes'):
        topic('/talk').wait_for()


@pytest.mark.slow
def test_the_nodes_of_a_lesson_stay_far_below_the_limit_of_endpoints():
    nodes = [live.run(Node, f'node_{number}', key=number) for number in range(5)]
    with Watcher() as here:
        here.spin_for(1.0)
        topics = [name for name, _ in here.node.get_topic_names_and_types()]
        assert len(here.node.get_service_names_and_types()) + len(topics) < 0.1 * (
            watcher.MOST_ENDPOINTS
        )
    assert len(nodes) == 5
    live.stop()


def test_a_look_at_an_ever_changing_graph_ends(monkeypatch):
    looks = iter(range(1_000_000))
    monkeypatch.setattr(graphs, 'MOST_TAKE_SEC', 0.0)
    monkeypatch.setattr(graphs, '_read_graph', lambda node: next(looks))
    monkeypatch.setattr(graphs, '_has_unknown', lambda picture: True)
    with Watcher() as here:
        assert graphs.take_snapshot(here) < 3


def test_a_name_that_is_no_text_fails_a_check(node, monkeypatch):
    def look_up(self):
        return b'\xff'.decode()

    monkeypatch.setattr(Node, 'get_topic_names_and_types', look_up)
    with pytest.raises(CheckFailed, match='names and types on the graph that are text, saw bytes'):
        topic('/talk').wait_for()


@pytest.mark.parametrize(
    'dds_name',
    ['rt/no name', 'rq/no name/set_parametersRequest'],
    ids=['of a topic', 'of a service'],
)
def test_a_name_that_ros_refuses_fails_a_check(node, dds_name):
    """DDS allows it, and rclpy raises if it is asked about such a topic or service."""
    node.create_publisher(String, '/talk', 1)
    interface = 'SetParameters_Request' if dds_name.startswith('rq/') else 'ParameterEvent'
    kind = 'srv' if dds_name.startswith('rq/') else 'msg'
    made = LatchedSubscription(
        node, dds_name, package='rcl_interfaces', kind=kind, message_name=interface
    )
    with pytest.raises(CheckFailed, match="names on the graph that ROS allows, saw '/no name"):
        topic('/talk').record(seconds=2.0)
    made.close()


def test_times_that_rclpy_cannot_read_fail_a_check(node, monkeypatch):
    """DDS has negative durations; rclpy raises if an endpoint's QoS has one."""

    def look_up(self, topic_name, no_mangle=False):
        raise OverflowError('Total nanoseconds value is too large to store in C duration.')

    node.create_publisher(String, '/talk', 1)
    monkeypatch.setattr(Node, 'get_publishers_info_by_topic', look_up)
    with pytest.raises(CheckFailed, match='QoS on the graph whose times are not negative'):
        topic('/talk').record(seconds=2.0)


@pytest.mark.parametrize('kind', [ValueError, OverflowError])
def test_an_error_in_a_check_is_not_reported_as_a_bad_name_on_the_graph(node, kind):
    with pytest.raises(kind, match='wrong'), Watcher():
        raise kind('wrong')


def test_a_watcher_waits_for_no_events():
    with Watcher() as here:
        assert not [
            event for event in here.node.waitables if event.callback_group.can_execute(event)
        ]


@pytest.fixture(params=['test', 'a notebook'])
def end_cell(request, monkeypatch):
    with grade_cell(monkeypatch) as end:
        if request.param == 'a notebook':
            monkeypatch.delenv('MY_ROBOT_BASICS_ROOM')
        yield end


def test_watchers_of_a_cell_share_a_participant_until_the_cell_ends(node, end_cell):
    with Watcher(shared=True) as first, Watcher(shared=True) as second, Watcher() as other:
        assert first.context is second.context
        assert other.context is not first.context
    assert first.context.ok()
    assert not other.context.ok()
    with Watcher(shared=True) as third:
        assert third.context is first.context
        assert third.spin_until(lambda: '/talker' in graphs.node_names(third.node), timeout_sec=10)
    # no watcher was open meanwhile, but the participant has discovered the node already
    with Watcher(shared=True) as next_one:
        assert '/talker' in graphs.node_names(next_one.node)
    end_cell()
    assert not first.context.ok()
    with Watcher(shared=True) as fourth:
        assert fourth.context is not first.context


def test_a_shared_participant_that_was_shut_down_is_replaced(end_cell):
    with Watcher(shared=True) as before:
        pass
    before.context.shutdown()
    with Watcher(shared=True) as after:
        assert after.context.ok()


def test_a_watcher_outside_a_kernel_ends_with_its_check(node):
    with Watcher(shared=True) as alone:
        assert alone.context.ok()
    assert not alone.context.ok()
