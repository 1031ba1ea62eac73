"""What counts as standing still: a node that waits, and no machine that is short of time."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import heartbeat


class Fake:
    """A watcher on a clock of its own, which messages reach at some of its seconds."""

    def __init__(self, beats_sec, *, free_share):
        self.beats_sec, self.free_share = list(beats_sec), free_share
        self.now_sec, self.received = 0.0, []

    def spin_until(self, done, *, timeout_sec):
        end_sec = self.now_sec + timeout_sec
        while self.beats_sec and self.beats_sec[0] <= end_sec:
            self.now_sec = max(self.now_sec, self.beats_sec.pop(0))
            self.received.append(self.now_sec)
            if done():
                return True
        self.now_sec = end_sec
        return False

    def stopwatch(self):
        began_sec = self.now_sec
        return SimpleNamespace(
            wall_sec=lambda: self.now_sec - began_sec,
            free_sec=lambda: (self.now_sec - began_sec) * self.free_share,
        )


def every(period_sec, *, start_sec=0.0, end_sec=60.0):
    return [start_sec + period_sec * n for n in range(round((end_sec - start_sec) / period_sec))]


def pausing(*, start_sec, end_sec, then_sec=0.1):
    """Ten times a second, but for a pause; once in `then_sec` behind it."""
    return [*every(0.1, end_sec=start_sec), *every(then_sec, start_sec=end_sec)]


BUSY, FREE = 0.0, 1.0


@pytest.mark.parametrize(
    ('beats_sec', 'free_share', 'goes_on'),
    [
        (every(0.1), FREE, True),
        (every(0.1), BUSY, True),
        ([], FREE, False),
        ([], BUSY, False),
        (pausing(start_sec=0.5, end_sec=1.0), FREE, True),
        (pausing(start_sec=0.5, end_sec=1.6), FREE, False),  # it waited for a second
        (pausing(start_sec=0.5, end_sec=2.5), BUSY, True),  # or had no processor
        (pausing(start_sec=0.5, end_sec=4.5), BUSY, False),  # too long for that, …
        (pausing(start_sec=0.5, end_sec=4.5, then_sec=1.2), BUSY, True),  # … unless it goes on
        (pausing(start_sec=0.5, end_sec=40.0), BUSY, False),
        ([0.01] * 100, FREE, False),  # counted ahead
        ([0.01] * 100, BUSY, False),
        ([*[0.01] * 100, *every(0.1, start_sec=10.0)], BUSY, False),
    ],
)
def test_only_a_silence_that_the_machine_does_not_explain_counts(
    monkeypatch, beats_sec, free_share, goes_on
):
    fake = Fake(beats_sec, free_share=free_share)
    monkeypatch.setattr(heartbeat, 'Stopwatch', fake.stopwatch)
    monkeypatch.setattr(heartbeat, 'wait_for_turn', lambda: None)
    assert heartbeat.Heartbeat(fake, SimpleNamespace(received=fake.received)).goes_on() is goes_on


class Waits(Fake):
    """Counts ten times a second, but while it waits for a while upon each message."""

    def __init__(self, waits_sec, **options):
        super().__init__(every(0.1), **options)
        self.waits_sec, self.sent = list(waits_sec), 0

    def send(self):
        self.sent += 1
        if self.waits_sec:
            end_sec = self.now_sec + self.waits_sec.pop(0)
            self.beats_sec = [max(each, end_sec) for each in self.beats_sec]


@pytest.mark.parametrize(
    ('waits_sec', 'goes_on', 'sent'),
    [
        ([], True, 1),
        ([1.0] * 3, False, 3),
        ([0.5] * 3, False, 3),
        # a machine that was short of time once, or twice
        ([1.0], True, 2),
        ([1.0, 0.5], True, 3),
        # short pauses are no waits
        ([0.3] * 3, True, 1),
    ],
)
def test_who_waits_upon_each_message_does_not_go_on_however_busy_the_machine_is(
    monkeypatch, waits_sec, goes_on, sent
):
    fake = Waits(waits_sec, free_share=BUSY)
    monkeypatch.setattr(heartbeat, 'Stopwatch', fake.stopwatch)
    monkeypatch.setattr(heartbeat, 'wait_for_turn', lambda: None)
    beats = heartbeat.Heartbeat(fake, SimpleNamespace(received=fake.received))
    assert (beats.goes_on(fake.send), fake.sent) == (goes_on, sent)


def test_a_machine_that_holds_everything_up_holds_up_no_message(monkeypatch):
    fake = Waits([1.0] * 3, free_share=BUSY)
    fake.beats_sec = every(0.7)
    monkeypatch.setattr(heartbeat, 'Stopwatch', fake.stopwatch)
    monkeypatch.setattr(heartbeat, 'wait_for_turn', lambda: None)
    beats = heartbeat.Heartbeat(fake, SimpleNamespace(received=fake.received))
    assert beats.goes_on(fake.send)
