"""A subscription of a check: which publishers it has discovered, and which it can never match."""

import pytest
from my_robot_basics.checks.recordings.recorder import Recorder
from my_robot_basics.graph.watcher import Watcher
from my_robot_basics.session import classroom
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


@pytest.fixture
def speaker():
    """A node of another participant."""
    context = Context()
    context.init(domain_id=classroom.enter())
    node = Node('speaker', context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.starts
def test_an_incompatible_publisher_is_not_waited_for(speaker):
    """A server of an action with feedback of BEST_EFFORT cost ten seconds in each check."""
    asked = {'/hidden': QoSProfile(depth=1), '/latched': LATCHED, '/fits': QoSProfile(depth=1)}
    with Watcher() as watcher:
        recorders = {
            name: Recorder(watcher, topic_name=name, type_=String, qos_profile=profile)
            for name, profile in asked.items()
        }
        watcher.spin_for(1.0)
        assert not any(each.is_connected() for each in recorders.values())
        made = [
            speaker.create_publisher(String, '/hidden', BEST_EFFORT),
            speaker.create_publisher(String, '/latched', QoSProfile(depth=1)),
        ]
        for name in '/hidden', '/latched':
            assert watcher.spin_until(recorders[name].is_connected, timeout_sec=30.0)
        assert not recorders['/fits'].is_connected()
        made.append(speaker.create_publisher(String, '/fits', LATCHED))
        assert watcher.spin_until(recorders['/fits'].is_connected, timeout_sec=30.0)
        made[-1].publish(String(data='met'))
        assert watcher.spin_until(lambda: bool(recorders['/fits'].received), timeout_sec=30.0)
