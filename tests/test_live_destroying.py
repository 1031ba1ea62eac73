"""A node that is stopped is gone with its action servers and clients, even while it is kept."""

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


def test_who_fails_in_the_constructor_leaves_it_too(run):
    with pytest.raises(RuntimeError, match='no') as failure:
        run(Fails)
    assert '/move_arm_server' not in graph().nodes()
    assert failure.value.args[1].server is not None


def test_the_server_of_a_node_that_is_replaced_answers_no_more(run):
    first = run(MoveArmServer)
    run(MoveArmServer)
    assert action('/move_arm', MoveArm).send_goal(moves.goal((0.2, 0.1))).status == 'succeeded'
    assert first.position == [0.0, 0.0]


class Speaker(Node):
    def __init__(self):
        super().__init__('speaker')
        self.logger = self.get_logger().get_child('voice')


def test_the_child_loggers_of_a_successor_go_on_when_the_former_is_garbage(run):
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
