"""A stopped node leaves the graph with its action servers and clients, even if referenced."""

import gc

import pytest
from my_robot_basics.checks import action, graph, moves
from my_robot_basics.graph.watcher import Watcher
from nodes.running import imported
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from arm_interfaces.action import MoveArm
from my_robot_basics import live

MoveArmServer = imported('move_arm_server').MoveArmServer


class Client(Node):
    def __init__(self):
        super().__init__('client')
        self.client = ActionClient(self, MoveArm, '/move_arm')


class Fails(MoveArmServer):
    def __init__(self):
        super().__init__()
        raise RuntimeError('no', self)


@pytest.mark.parametrize('node_class', [MoveArmServer, Client])
def test_a_stopped_node_leaves_the_graph(run, node_class):
    node = run(node_class)
    name = node.get_fully_qualified_name()
    assert name in graph().nodes()
    live.stop()
    assert name not in graph().nodes()


def test_a_node_that_fails_in_its_constructor_leaves_the_graph(run):
    with pytest.raises(RuntimeError, match='no') as failure:
        run(Fails)
    assert '/move_arm_server' not in graph().nodes()
    assert failure.value.args[1].server is not None


def test_the_action_server_of_a_replaced_node_executes_no_goal(run):
    first = run(MoveArmServer)
    run(MoveArmServer)
    assert action('/move_arm', MoveArm).send_goal(moves.goal((0.2, 0.1))).status == 'succeeded'
    assert first.position == [0.0, 0.0]


class Speaker(Node):
    def __init__(self):
        super().__init__('speaker')
        self.logger = self.get_logger().get_child('voice')


def test_child_loggers_of_a_new_node_still_log_after_the_old_logger_is_collected(run):
    heard = []
    with Watcher(listens=True) as watcher:
        latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        watcher.node.create_subscription(Log, '/rosout', lambda m: heard.append(m.msg), latched)
        former = run(Speaker)
        second = run(Speaker)
        del former.logger
        gc.collect()
        second.logger.info('here')
        assert watcher.spin_until(lambda: 'here' in heard, timeout_sec=5.0)


class OwnLogger(Node):
    def __init__(self):
        super().__init__('own_logger')
        self._logger = None


def test_a_node_that_has_overwritten_its_logger_leaves_the_graph(run):
    speaker = run(Speaker)
    run(OwnLogger)
    live.stop(OwnLogger)
    assert graph().nodes() == ('/speaker',)
    assert speaker.logger.name == 'speaker.voice'


@pytest.mark.filterwarnings('error::pytest.PytestUnhandledThreadExceptionWarning')
def test_a_node_that_a_cell_has_destroyed_is_replaced(run):
    former = run(Speaker)
    former.destroy_node()
    second = run(Speaker)
    second.destroy_node()
    live.stop(Speaker)
    assert graph().nodes() == ()
