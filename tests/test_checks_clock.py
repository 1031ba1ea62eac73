"""Plain timers: exact on the clock that a check drives, and back on wall time after it."""

import threading
import time

import pytest
from my_robot_basics.checks import CheckFailed, clock, looks, topic
from nodes.running import imported, running
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor

TOPIC = '/kinematics/joint_states'


pytestmark = pytest.mark.usefixtures('patient')


@pytest.fixture
def patient(monkeypatch):
    """No limit of wall time: what is exact must be so on any machine."""
    for limit in ('BUDGET_SEC', 'SLOWEST_BARRIER_SEC', 'SLOWEST_MEDIAN_SEC'):
        monkeypatch.setattr(clock, limit, 100.0)


@pytest.mark.parametrize(
    ('node', 'seconds', 'hz', 'messages'),
    [
        ('five_hz', 60.0, 5.0, 300),
        ('own_thread', 10.0, 5.0, 50),
        ('best_effort', 10.0, 5.0, 50),
        ('one_hz', 10.0, 1.0, 10),
        ('fifth_hz', 20.0, 0.2, 4),
        ('fifty_hz', 5.0, 50.0, 250),
    ],
)
def test_a_timer_is_judged_exactly_on_the_robots_clock(capfd, node, seconds, hz, messages):
    with running(node):
        recording = topic(TOPIC).record(seconds=seconds)
    recording.assert_rate(hz=hz)
    assert (recording.clock, len(recording.messages)) == ('simulated', messages)
    assert capfd.readouterr() == ('', '')


@pytest.mark.parametrize('node', ['five_hz', 'one_hz'])
def test_a_node_is_alive_on_wall_time_after_a_check(node):
    with running(node):
        topic(TOPIC).record(seconds=10.0)
        message = topic(TOPIC).wait_for(timeout_sec=5.0)
        stamp = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
    # far from the time that the check had simulated: 10 s ahead
    assert abs(stamp - time.time()) < 5.0


@pytest.mark.parametrize('error', [KeyboardInterrupt, CheckFailed])
def test_a_node_is_alive_after_a_check_that_was_cut_short(monkeypatch, error):
    def interrupt(*args, **kwargs):
        raise error

    with running('five_hz'):
        monkeypatch.setattr(looks, '_find_step', interrupt)
        with pytest.raises(error):
            topic(TOPIC).record()
        topic(TOPIC).wait_for(timeout_sec=5.0)


def test_a_check_waits_for_a_node_that_is_slow_to_return():
    # what looks at it next would find it frozen, on a clock that nobody drives any more
    with Context() as context:
        node = imported('slow_to_return').SlowToReturn(context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin)
        thread.start()
        try:
            topic(TOPIC).record(seconds=1.0)
            assert node.returned
        finally:
            executor.shutdown()
            thread.join()
            node.destroy_node()
