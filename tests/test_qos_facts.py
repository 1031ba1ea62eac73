"""What lesson 6 says of QoS without showing it."""

import pytest
from my_robot_basics.live import run, stop, wait_until
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32


@pytest.fixture
def pair():
    yield run(Node, 'offers', key='offers'), run(Node, 'asks', key='asks')
    stop()


def test_without_event_callbacks_both_sides_log_a_misfit(pair, capfd):
    offers, asks = pair
    offers.create_publisher(
        Int32, '/misfit', QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    )
    asks.create_subscription(Int32, '/misfit', print, 1)
    logged = []

    def both_have_logged():
        logged.append(capfd.readouterr().out)
        return {'[offers]', '[asks]'} <= {word.strip(':') for word in ''.join(logged).split()}

    wait_until(both_have_logged)
    for line in ''.join(logged).splitlines():
        assert line.startswith('[WARN]')
        assert line.endswith('Last incompatible policy: RELIABILITY')
