"""Plain timers: exact on the clock that a check drives, and back on wall time after it."""

import contextlib
import threading
import time

import pytest
from my_robot_basics.checks import CheckFailed, clock, looks, topic
from my_robot_basics.checks.watcher import Watcher
from nodes.running import imported, running
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.clock import Clock as RclpyClock
from rclpy.clock import ClockType
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

TOPIC = '/kinematics/joint_states'


pytestmark = pytest.mark.usefixtures('patient')


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


@contextlib.contextmanager
def spinning(make_node):
    """A node in this process that is spun in a thread for the duration of a with statement."""
    with Context() as context:
        node = make_node(context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        thread = threading.Thread(target=executor.spin)
        thread.start()
        try:
            yield node
        finally:
            executor.shutdown()
            thread.join()
            node.destroy_node()


def test_a_check_waits_for_a_node_that_is_slow_to_return():
    # what looks at it next would find it frozen, on a clock that nobody drives any more
    slow_to_return = imported('slow_to_return').SlowToReturn
    with spinning(lambda context: slow_to_return(context=context)) as node:
        topic(TOPIC).record(seconds=1.0)
        assert node.returned


class Gate(ReentrantCallbackGroup):
    """Lets no callback through while it is closed, as an executor whose threads are all busy."""

    is_closed = False

    def can_execute(self, entity):
        return not self.is_closed and super().can_execute(entity)


def test_a_timer_that_was_due_when_the_clock_was_given_back_is_not_left_in_the_future():
    # rcl carries over what is left of the period, unless that is exactly nothing
    gate, fired = Gate(), threading.Event()

    def make_node(context):
        node = Node('late', context=context)
        node.create_timer(0.2, fired.set, callback_group=gate)
        # whatever the robot's clock does, the executor wakes up and sees that the gate is open
        node.create_timer(0.1, lambda: None, clock=RclpyClock(clock_type=ClockType.STEADY_TIME))
        return node

    with spinning(make_node), Watcher() as watcher:
        with clock.SimulatedClock(watcher, needed={'/late'}) as simulated:
            simulated.tick(60 * 10**9)
            # a clock that goes back sets the timer anew: its next call is exactly 0.2 s ahead
            simulated.tick(-(10**9))
            gate.is_closed = True
            simulated.tick(2 * 10**8)
        gate.is_closed = False
        fired.clear()
        assert fired.wait(10.0)
