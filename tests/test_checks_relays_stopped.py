"""A node that passes messages on until its callback raises, does not return, or ends the node."""

import time

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.relays import relays
from relaying import Counts, check_delivery, check_late_joiner, monitor
from sensor_msgs.msg import JointState


class RaisesEachSecond(Counts):
    def chosen(self, received):
        if len(received) % 2 == 0:
            raise ValueError('an even number')
        return received[-1:]


class RaisesOnceAfterwards(monitor.JointStateMonitor):
    def changed(self, publish):
        received = []

        def receive(message):
            publish(message)
            received.append(message)
            if len(received) == 7:
                raise ValueError('the seventh')

        return receive


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (RaisesEachSecond, 'its callback raised ValueError: an even number .*fix that first'),
        (RaisesOnceAfterwards, 'its callback raised ValueError: the seventh .*fix that first'),
    ],
)
def test_a_callback_that_raised_is_named(run, node_class, reason):
    run(node_class)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(CheckFailed, match=reason):
            check()


class DestroysItself(monitor.JointStateMonitor):
    def changed(self, publish):
        received = []

        def receive(message):
            publish(message)
            received.append(message)
            if len(received) == 3:
                self.destroy_node()

        return receive


class StandsStill(monitor.JointStateMonitor):
    def changed(self, publish):
        def receive(message):
            publish(message)
            time.sleep(15.0)

        return receive


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (DestroysItself, r'the node has ended: leave .* destroy_node\(\)'),
        (StandsStill, r'its callback has not returned \(line \d+: time\.sleep'),
    ],
)
def test_a_node_that_stops_between_two_messages_fails_with_the_cause(run, node_class, reason):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_delivery()


@pytest.mark.slow
@pytest.mark.timeout(120)
def test_a_check_does_not_wait_for_a_message_on_which_a_callback_raised(run, monkeypatch):
    class Raises(monitor.JointStateMonitor):
        def changed(self, publish):
            def receive(message):
                raise ValueError('at each')

            return receive

    monkeypatch.setattr(relays, 'LOST_SEC', 3600.0)
    run(Raises)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(CheckFailed, match='saw none in 1 s: its callback raised ValueError'):
            check()


@pytest.mark.slow
def test_an_earlier_exception_is_not_blamed_for_the_other_topic(run):
    class Raises(monitor.JointStateMonitor):
        def changed(self, publish):
            def receive(message):
                if isinstance(message, JointState):
                    raise ValueError('no pose')
                publish(message)

            return receive

    run(Raises)
    with pytest.raises(CheckFailed, match='its callback raised ValueError: no pose'):
        check_delivery()
    check_late_joiner()
