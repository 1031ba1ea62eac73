"""A subscription that is not TRANSIENT_LOCAL gets no earlier messages, in any try."""

import itertools
from contextlib import nullcontext

import pytest
from my_robot_basics.checks import CheckFailed, relay
from my_robot_basics.checks.topics.latched import published_before_discovery
from nodes.running import imported, running
from rclpy.node import Node
from std_msgs.msg import String

from my_robot_basics import live

numbers = itertools.count()


def description():
    return String(data=f'an arm with {next(numbers)} joints')


@pytest.mark.slow
@pytest.mark.parametrize('times', [5, pytest.param(200, marks=pytest.mark.timeout(1200))])
@pytest.mark.parametrize('place', ['here', 'elsewhere'])
def test_a_volatile_subscription_never_receives_earlier_messages(run, place, times):
    heard, said_before = [], set()
    probe = run(Node, 'probe')
    probe.create_subscription(
        String, '/monitor/arm_description', lambda message: heard.append(message.data), 10
    )
    with volatile_monitor(run, place):
        # messages that the monitor publishes before it has discovered us would be lost
        greeter = probe.create_publisher(String, '/arm_description', 10)
        live.wait_until(lambda: greeter.publish(String(data='hello')) or 'hello' in heard, 20.0)
        probe.destroy_publisher(greeter)
        for _ in range(times):
            with published_before_discovery('/arm_description', description) as (
                message,
                publisher,
            ):
                said_before.add(message.data)
                # what comes later does arrive, and messages of a publisher keep their order
                later = description()
                live.wait_until(lambda p=publisher: p.get_subscription_count() > 0, 10.0)
                publisher.publish(later)
                live.wait_until(lambda text=later.data: text in heard, 10.0)
            with pytest.raises(CheckFailed, match='saw VOLATILE'):
                relay('/arm_description', to='/monitor/arm_description').assert_carries_latched(
                    description
                )
    assert not said_before & set(heard)


def volatile_monitor(run, place):
    if place == 'elsewhere':
        return running('monitor_volatile')
    return nullcontext(run(imported('joint_state_monitor').JointStateMonitor, description=10))
