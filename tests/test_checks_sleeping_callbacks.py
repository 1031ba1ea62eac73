"""A callback that sleeps is named as the reason why a node is too slow, and only then."""

import time
from dataclasses import replace

import pytest
from my_robot_basics.checks import CheckFailed, rate_parameter, topic
from my_robot_basics.exchange import node_troubles
from rclpy.node import Node
from std_msgs.msg import Int32


class Sleeps(Node):
    """Publishes at a rate, but for the time that its callback sleeps."""

    def __init__(self, period_sec, sleep_sec):
        super().__init__('sleeps')
        self.sleep_sec = sleep_sec
        self.publisher = self.create_publisher(Int32, '/counts', 10)
        self.timer = self.create_timer(period_sec, self.publish)
        self.declare_parameter('rate_hz', 1.0 / period_sec)
        self.add_post_set_parameters_callback(self.change)

    def publish(self):
        time.sleep(self.sleep_sec)
        self.publisher.publish(Int32())

    def change(self, parameters):
        for parameter in parameters:
            if parameter.name == 'rate_hz':
                self.timer.timer_period_ns = int(1e9 / parameter.value)


NAMED = (
    r'a callback sleeps in line \d+ \(time\.sleep\(self\.sleep_sec\)\), and meanwhile the timer '
    'cannot call anything: leave the sleep out$'
)


def test_a_sleep_that_makes_the_node_too_slow_is_named(run):
    run(Sleeps, 0.05, 0.2)
    with pytest.raises(CheckFailed, match=NAMED):
        topic('/counts').record(seconds=4.0).assert_rate(hz=20.0)


def test_it_is_named_in_place_of_what_the_timer_lacks(run):
    run(Sleeps, 0.25, 0.22)
    rate = rate_parameter('/sleeps', 'rate_hz', topic_name='/counts')
    with pytest.raises(CheckFailed, match=NAMED):
        rate.expect_follows(40.0)


def test_nothing_is_asked_about_a_rate_on_the_robots_clock(run, monkeypatch):
    monkeypatch.setattr(node_troubles, 'sleeping_line', pytest.fail)
    run(Sleeps, 1.0, 0.01)
    recording = topic('/counts').record(seconds=4.0)
    assert recording.clock == 'simulated'
    with pytest.raises(CheckFailed, match='period = 1 / rate'):
        recording.assert_rate(hz=5.0)


def test_a_short_sleep_is_not_named_for_another_mistake(run):
    run(Sleeps, 1.0, 0.01)
    recording = replace(topic('/counts').record(seconds=4.0), clock='wall')
    with pytest.raises(CheckFailed, match='the timer period is in seconds, and period = 1 / rate'):
        recording.assert_rate(hz=5.0)
