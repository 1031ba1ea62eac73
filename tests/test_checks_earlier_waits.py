"""In a grade cell, no check waits again for something that another check has waited for."""

from types import SimpleNamespace

import pytest
from grade_cell import grade_cell
from my_robot_basics.checks import service
from my_robot_basics.checks.relays.passage import Passage
from my_robot_basics.graph import graphs
from my_robot_basics.graph.watcher import Watcher
from rclpy.node import Node
from relaying import check_delivery, monitor
from std_msgs.msg import String
from std_srvs.srv import Trigger

from my_robot_basics import live

pytestmark = pytest.mark.starts
NEVER_SEC = 1e6


@pytest.fixture
def end_cell(monkeypatch):
    with grade_cell(monkeypatch) as end:
        yield end


@pytest.fixture
def node():
    yield live.run(Node, 'talker', key='talker')
    live.stop()


def is_met(topic_name):
    with Watcher(shared=True) as watcher:
        return graphs.wait_for_publisher(watcher, topic_name, timeout_sec=3.0)


def test_the_wait_for_a_publisher_happens_once_in_a_grade_cell(node, end_cell, monkeypatch):
    node.create_publisher(String, '/talk', 10)
    assert is_met('/talk')
    monkeypatch.setattr(graphs, 'NEWCOMER_SEC', NEVER_SEC)
    assert is_met('/talk')
    end_cell()
    assert not is_met('/talk')


def test_a_new_publisher_is_waited_for_in_the_same_cell(node, end_cell, monkeypatch):
    node.create_publisher(String, '/talk', 10)
    assert is_met('/talk')
    monkeypatch.setattr(graphs, 'NEWCOMER_SEC', NEVER_SEC)
    node.create_publisher(String, '/talk', 10)
    assert not is_met('/talk')


def test_each_check_waits_outside_a_grade_cell(node, monkeypatch):
    node.create_publisher(String, '/talk', 10)
    assert is_met('/talk')
    monkeypatch.setattr(graphs, 'NEWCOMER_SEC', NEVER_SEC)
    assert not is_met('/talk')


def test_the_wait_for_a_service_happens_once_in_a_grade_cell(node, end_cell, monkeypatch):
    node.create_service(Trigger, '/go', lambda request, response: response)
    waits = []
    spin_for = Watcher.spin_for
    monkeypatch.setattr(Watcher, 'spin_for', lambda *args: waits.append(args) or spin_for(*args))
    for _ in range(3):
        service('/go', Trigger).call(Trigger.Request())
    assert len(waits) == 1
    end_cell()
    service('/go', Trigger).call(Trigger.Request())
    assert len(waits) == 2


def test_a_relay_is_tested_after_a_pause_once_in_a_grade_cell(run, end_cell, monkeypatch):
    looks = []
    monkeypatch.setattr(Passage, 'loses_after_a_pause', lambda *_: bool(looks.append(1)))
    run(monitor.JointStateMonitor)
    check_delivery()
    check_delivery()
    assert len(looks) == 1
    run(monitor.JointStateMonitor)
    check_delivery()
    assert len(looks) == 2


@pytest.mark.parametrize(('most', 'is_there'), [(1, False), (graphs.MANY_NEWCOMERS, True)])
def test_a_topic_with_ever_new_publishers_counts_as_published(monkeypatch, most, is_there):
    """A node that makes a publisher for each message never has the last one."""
    infos = []

    def newcomers(node, topic_name):
        if len(infos) < most:
            gid = (len(infos),)
            infos.append(SimpleNamespace(node_name='talker', topic_type='T', endpoint_gid=gid))
        return infos

    monkeypatch.setattr(graphs, 'publisher_infos', newcomers)
    monkeypatch.setattr(graphs, 'NEWCOMER_SEC', NEVER_SEC)
    with Watcher() as watcher:
        assert graphs.wait_for_publisher(watcher, '/talk', timeout_sec=0.5) is is_there
