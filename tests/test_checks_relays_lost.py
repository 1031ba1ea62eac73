"""A node that passes messages on and loses some, sends them late or more than once."""

import time
from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.relays import enough, passage, relays
from relaying import (
    Counts,
    check_delivery,
    check_late_joiner,
    joint_states,
    monitor,
    pose,
)
from sensor_msgs.msg import JointState


class DropsEverySecond(Counts):
    def chosen(self, received):
        return received[-1:] if len(received) % 2 else []


class DropsEveryTenth(Counts):
    def chosen(self, received):
        return received[-1:] if len(received) % 10 else []


class DropsEveryEleventh(Counts):
    def chosen(self, received):
        return received[-1:] if len(received) % 11 else []


class DropsEveryHundredth(Counts):
    def chosen(self, received):
        return received[-1:] if len(received) % 100 else []


class DropsEqualOnes(Counts):
    def chosen(self, received):
        return received[-1:] if received[-1:] != received[-2:-1] else []


class DropsZeros(Counts):
    def chosen(self, received):
        return received[-1:] if any(received[-1].position) else []


class DropsNegativeOnes(Counts):
    def chosen(self, received):
        return received[-1:] if min(received[-1].position) >= 0.0 else []


class DropsLargeOnes(Counts):
    def chosen(self, received):
        return received[-1:] if max(received[-1].position) < 2000.0 else []


class FillsInTheFrame(Counts):
    def chosen(self, received):
        header = received[-1].header
        header.frame_id = header.frame_id or 'base_link'
        return received[-1:]


class ZipsAllLists(Counts):
    def chosen(self, received):
        last = received[-1]
        joints = list(zip(last.name, last.position, last.velocity, last.effort, strict=False))
        lists = map(list, zip(*joints, strict=True)) if joints else ([], [], [], [])
        fields = 'name', 'position', 'velocity', 'effort'
        return [JointState(header=last.header, **dict(zip(fields, lists, strict=True)))]


class DropsEmptyTexts(Counts):
    def chosen(self, received):
        return received[-1:] if received[-1].data else []


class DropsWhatComesSoon(Counts):
    def chosen(self, received):
        now, before = time.monotonic(), getattr(self, 'before', 0.0)
        if now - before < 0.2:
            return []
        self.before = now
        return received[-1:]


class DropsAfterAPause(Counts):
    def chosen(self, received):
        now, before = time.monotonic(), getattr(self, 'before', 0.0)
        self.before = now
        return received[-1:] if now - before < 1.0 else []


class Lags(Counts):
    def chosen(self, received):
        return received[-2:-1]


class Doubles(Counts):
    def chosen(self, received):
        return received[-1:] * 2


class DoublesEachHundredth(Counts):
    def chosen(self, received):
        return received[-1:] * (1 if len(received) % 100 else 2)


class RepeatsTheLast(Counts):
    """Publishes the last message again if nothing arrives for a given time"""

    def chosen(self, received):
        if not hasattr(self, 'idle'):
            self.idle = self.create_timer(0.4, lambda: self.publish_last())
        self.idle.reset()
        return received[-1:]

    def changed(self, publish):
        receive = super().changed(publish)

        def keep(message):
            self.publish_last = lambda: publish(message)
            receive(message)

        return keep


class SwapsPairs(Counts):
    def chosen(self, received):
        return [] if len(received) % 2 else received[:-3:-1]


@pytest.fixture
def all_the_time(monkeypatch):
    """Give checks more time on any machine: two lost messages do not show a pattern."""
    monkeypatch.setattr(passage, 'MOST_SEC', 60.0)


@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (DropsEverySecond, 'saw messages that are not republished: publish in every call'),
        (DropsEveryTenth, 'saw messages that are not republished: publish in every call'),
        (DropsEveryEleventh, 'saw messages that are not republished: publish in every call'),
        (DropsEqualOnes, 'not republished: those equal to the one before: publish in every call'),
        (DropsZeros, 'not republished: those with zeros, or empty: publish in every call'),
        (DropsNegativeOnes, 'not republished: those with negative numbers: publish in every call'),
        (DropsLargeOnes, 'not republished: those with large numbers: publish in every call'),
        (
            FillsInTheFrame,
            'those without a stamp and a frame: publish in every call of the callback',
        ),
        (ZipsAllLists, 'not republished: those without velocities and efforts: publish in every'),
        (DropsWhatComesSoon, 'saw messages that are not republished'),
        (DropsAfterAPause, 'not republished when it is the first after a pause: publish'),
        (Lags, 'is republished only when the next one arrives: publish the message'),
        (SwapsPairs, 'saw a message that is republished only when the next one arrives'),
        (Doubles, 'a message that is republished 2 times: subscribe once'),
        (RepeatsTheLast, r'a message that is republished [2-5] times: subscribe once'),
    ],
)
def test_a_relay_that_loses_delays_or_repeats_messages_fails(
    run, all_the_time, node_class, reason
):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_delivery()


class LeavesOutTheFirstHundred(monitor.JointStateMonitor):
    def changed(self, publish):
        received = []

        def receive(message):
            received.append(message)
            if len(received) > 100:
                publish(message)

        return receive


@pytest.mark.slow
@pytest.mark.timeout(120)
def test_a_relay_that_drops_its_first_hundred_messages_fails(run, monkeypatch):
    turns = range(1, 201)  # of a machine that is busy all the time
    monkeypatch.setattr(relays, 'awake_turns', lambda free_sec, names: iter(turns))
    run(LeavesOutTheFirstHundred)
    with pytest.raises(CheckFailed, match='to be republished on /monitor/joint_states, unchanged'):
        check_delivery()


def test_a_first_message_that_is_not_republished_is_resent_and_later_less_often(monkeypatch):
    monkeypatch.setattr(relays, 'awake_turns', lambda free_sec, names: iter(range(1, 201)))
    monkeypatch.setattr(relays.RelayEndpoints, 'why_lost', lambda *_, **__: 'look')
    watcher = SimpleNamespace(spin_until=lambda done, timeout_sec: done())
    recorder = SimpleNamespace(messages=list, publishers=tuple)
    raised = SimpleNamespace(hint=str)
    sent = []
    with pytest.raises(CheckFailed, match='saw none in 4 s: look'):
        joint_states._expect_out(
            watcher, recorder, pose(), raised, again=SimpleNamespace(publish=sent.append)
        )
    assert len(sent) == 40 + 160 / 10


def test_the_passage_check_knows_the_first_message_that_was_resent(run, monkeypatch):
    earlier = []

    class Told(passage.Passage):
        def __init__(self, *args, **options):
            earlier.append(options['earlier'])
            super().__init__(*args, **options)

    monkeypatch.setattr(relays, 'Passage', Told)
    run(monitor.JointStateMonitor)
    check_delivery()
    check_late_joiner()
    assert [type(message) for message in earlier] == [JointState, type(None)]


@pytest.fixture
def leisurely(monkeypatch):
    monkeypatch.setattr(enough, 'SOME_SEC', 300.0)
    monkeypatch.setattr(passage, 'MOST_SEC', 300.0)


@pytest.mark.slow
@pytest.mark.usefixtures('leisurely')
def test_a_relay_that_drops_every_hundredth_message_fails_given_enough_time(run):
    run(DropsEveryHundredth)
    with pytest.raises(CheckFailed, match='saw messages that are not republished'):
        check_delivery()


@pytest.mark.slow
@pytest.mark.usefixtures('leisurely')
def test_a_relay_that_doubles_every_hundredth_message_fails_given_enough_time(run):
    run(DoublesEachHundredth)
    with pytest.raises(CheckFailed, match='a message that is republished 2 times: subscribe once'):
        check_delivery()


@pytest.mark.slow
@pytest.mark.parametrize('node_class', [DropsEverySecond, DropsEveryEleventh])
def test_a_relay_that_drops_messages_fails_even_without_time_left(run, monkeypatch, node_class):
    monkeypatch.setattr(enough, 'SOME_SEC', 0.0)
    monkeypatch.setattr(enough, 'LONG_SEC', 0.0)
    run(node_class)
    with pytest.raises(CheckFailed, match='saw messages that are not republished'):
        check_delivery()


@pytest.mark.slow
def test_a_correct_relay_passes_even_without_time_left(run, monkeypatch):
    monkeypatch.setattr(enough, 'SOME_SEC', 0.0)
    monkeypatch.setattr(enough, 'LONG_SEC', 0.0)
    monkeypatch.setattr(passage, 'MOST_SEC', 0.0)
    run(monitor.JointStateMonitor)
    check_delivery()


@pytest.mark.slow
def test_a_description_that_is_republished_twice_fails(run):
    run(Doubles)
    with pytest.raises(CheckFailed, match='a message that is republished 2 times: subscribe once'):
        check_late_joiner()


@pytest.mark.slow
@pytest.mark.parametrize(
    ('node_class', 'reason'),
    [
        (DropsEqualOnes, 'not republished: those equal to the one before: publish in every call'),
        (DropsEmptyTexts, 'not republished: those with zeros, or empty: publish in every call'),
        (DropsEveryEleventh, 'saw messages that are not republished: publish in every call'),
    ],
)
def test_a_relay_that_drops_later_descriptions_fails(run, all_the_time, node_class, reason):
    run(node_class)
    with pytest.raises(CheckFailed, match=reason):
        check_late_joiner()


@pytest.mark.slow
def test_a_timer_that_republishes_only_the_latest_message_fails(run):
    class Latest(Counts):
        def __init__(self):
            self.latest = {}
            super().__init__()
            self.create_timer(0.1, self.flush)

        def changed(self, publish):
            return lambda message: self.latest.update({publish: message})

        def flush(self):
            while self.latest:
                publish, message = self.latest.popitem()
                publish(message)

    run(Latest)
    for check in check_delivery, check_late_joiner:
        with pytest.raises(
            CheckFailed, match='saw two messages in quick succession of which only'
        ):
            check()


@pytest.mark.slow
def test_a_queue_that_a_timer_republishes_passes(run):
    class Queues(Counts):
        def __init__(self):
            self.queue = []
            super().__init__()
            self.create_timer(0.1, self.flush)

        def changed(self, publish):
            return lambda message: self.queue.append((publish, message))

        def flush(self):
            while self.queue:
                publish, message = self.queue.pop(0)
                publish(message)

    run(Queues)
    check_delivery()
    check_late_joiner()
