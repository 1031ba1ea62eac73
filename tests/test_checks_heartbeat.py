"""What counts as standing still: a node that waits, but not a machine that is short of time."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import CheckFailed
from my_robot_basics.checks.topics import heartbeat
from my_robot_basics.feedback.errors import Starved


class Fake:
    """A watcher on a clock of its own, which messages reach at some of its seconds."""

    def __init__(self, beats_sec, *, free_share):
        self.beats_sec, self.free_share = list(beats_sec), free_share
        self.now_sec, self.received, self.turn_sec = 0.0, [], 0.0

    def spin_until(self, done, *, timeout_sec):
        end_sec = self.now_sec + timeout_sec
        while self.beats_sec and self.beats_sec[0] <= end_sec:
            self.now_sec = max(self.now_sec, self.beats_sec.pop(0))
            self.received.append(self.now_sec)
            if done():
                return True
        self.now_sec = end_sec
        return False

    def wait_for_turn(self):
        self.now_sec += self.turn_sec

    def stopwatch(self):
        began_sec = self.now_sec
        return SimpleNamespace(
            wall_sec=lambda: self.now_sec - began_sec,
            free_sec=lambda: (self.now_sec - began_sec) * self.free_share,
        )


def every(period_sec, *, start_sec=0.0, end_sec=60.0):
    return [start_sec + period_sec * n for n in range(round((end_sec - start_sec) / period_sec))]


def pausing(*, start_sec, end_sec, then_sec=0.1):
    """Ten times a second, except for a pause; after it, once in `then_sec`."""
    return [*every(0.1, end_sec=start_sec), *every(then_sec, start_sec=end_sec)]


BUSY, FREE = 0.0, 1.0


@pytest.fixture
def look(monkeypatch):
    """Return whether the count goes on, and what to raise if it does not."""

    def look(fake, *send):
        monkeypatch.setattr(heartbeat, 'Stopwatch', fake.stopwatch)
        monkeypatch.setattr(heartbeat, 'wait_for_turn', fake.wait_for_turn)
        beats = heartbeat.Heartbeat(
            fake, SimpleNamespace(received=fake.received, publishers=lambda: ())
        )
        return 'goes on' if beats.goes_on(*send) else beats.doubt

    return look


@pytest.mark.parametrize(
    ('beats_sec', 'free_share', 'expected'),
    [
        (every(0.1), FREE, 'goes on'),
        (every(0.1), BUSY, 'goes on'),
        ([], FREE, CheckFailed),
        ([], BUSY, CheckFailed),
        (pausing(start_sec=0.5, end_sec=1.0), FREE, 'goes on'),
        (pausing(start_sec=0.5, end_sec=1.6), FREE, CheckFailed),  # it waited for a second
        (pausing(start_sec=0.5, end_sec=2.5), BUSY, 'goes on'),  # or had no processor
        (pausing(start_sec=0.5, end_sec=4.5), BUSY, Starved),  # or others were many for a while, …
        (pausing(start_sec=0.5, end_sec=9.5), BUSY, Starved),
        (
            pausing(start_sec=0.5, end_sec=4.5, then_sec=1.2),
            BUSY,
            'goes on',
        ),  # … as they still are
        (pausing(start_sec=0.5, end_sec=4.5), 0.25, CheckFailed),  # a part of it was free
        (pausing(start_sec=0.5, end_sec=40.0), BUSY, CheckFailed),
        ([*every(0.1, end_sec=0.5), *every(0.1, start_sec=4.0, end_sec=4.5)], BUSY, CheckFailed),
        ([0.01] * 100, FREE, CheckFailed),  # counted ahead
        ([0.01] * 100, BUSY, CheckFailed),
        ([*[0.01] * 100, *every(0.1, start_sec=8.0)], BUSY, Starved),
        ([*[0.01] * 100, *every(0.1, start_sec=12.0)], BUSY, CheckFailed),
    ],
)
def test_only_silence_that_a_busy_machine_cannot_explain_fails(
    look, beats_sec, free_share, expected
):
    assert look(Fake(beats_sec, free_share=free_share)) == expected


def test_a_beat_that_comes_during_the_wait_for_a_turn_counts(look):
    fake = Fake(pausing(start_sec=0.5, end_sec=2.0), free_share=0.5)
    fake.turn_sec = 0.1
    assert look(fake) == 'goes on'


class Waits(Fake):
    """Counts ten times a second, except while it waits after each message."""

    def __init__(self, waits_sec, **options):
        super().__init__(every(0.1), **options)
        self.waits_sec, self.sent = list(waits_sec), 0

    def send(self):
        self.sent += 1
        if self.waits_sec:
            end_sec = self.now_sec + self.waits_sec.pop(0)
            self.beats_sec = [max(each, end_sec) for each in self.beats_sec]


@pytest.mark.parametrize(
    ('waits_sec', 'free_share', 'expected', 'sent'),
    [
        ([], BUSY, 'goes on', 1),
        ([4.0] * 3, BUSY, CheckFailed, 3),
        ([1.0] * 3, BUSY, CheckFailed, 3),
        # what a message takes a node on a busy machine, or a short wait
        ([0.5] * 3, BUSY, Starved, 3),
        ([0.5] * 3, 0.4, Starved, 3),
        ([0.5] * 3, 0.6, CheckFailed, 3),
        # a machine that was short of time once, or twice
        ([1.0], BUSY, 'goes on', 2),
        ([1.0, 0.5], BUSY, 'goes on', 3),
        ([4.0], BUSY, Starved, 2),
        # short pauses are no waits
        ([0.3] * 3, FREE, 'goes on', 1),
    ],
)
def test_waits_after_each_message_are_distinguished_from_a_busy_machine(
    look, waits_sec, free_share, expected, sent
):
    fake = Waits(waits_sec, free_share=free_share)
    assert (look(fake, fake.send), fake.sent) == (expected, sent)


def test_a_machine_that_delays_all_beats_is_not_taken_for_a_waiting_node(look):
    fake = Waits([1.0] * 3, free_share=BUSY)
    fake.beats_sec = every(0.7)
    assert look(fake, fake.send) == 'goes on'
