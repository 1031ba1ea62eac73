"""What counts as standing still: a node that waits, and no machine that is short of time."""

from types import SimpleNamespace

import pytest
from my_robot_basics.checks import pulse
from my_robot_basics.checks.clock import Inconclusive


class Fake:
    """A watcher whose every look takes LOOK_SEC; a beat comes at each of some looks."""

    def __init__(self, beats_at, *, free_share):
        self.beats_at, self.free_share = set(beats_at), free_share
        self.looks, self.received = 0, []

    def spin_until(self, done, *, timeout_sec):
        self.looks += 1
        if self.looks in self.beats_at:
            self.received.append(self.looks)
        return done()

    def stopwatch(self):
        began = self.looks
        return SimpleNamespace(
            free_sec=lambda: (self.looks - began) * pulse.LOOK_SEC * self.free_share
        )


CROWDED, FREE = 0.0, 1.0
SHORT, LONG = ([*range(1, 4), *range(end, 1000)] for end in (34, 64))


@pytest.mark.parametrize(
    ('beats_at', 'free_share', 'goes_on'),
    [
        (range(1, 1000), FREE, True),
        (range(1, 1000), CROWDED, True),
        ([], FREE, False),
        ([], CROWDED, False),
        (range(1, 4), FREE, False),
        (SHORT, FREE, False),  # it waited for three seconds
        (LONG, FREE, False),
        (SHORT, CROWDED, True),  # nobody had a processor for three seconds
    ],
)
def test_only_time_that_was_free_counts(monkeypatch, beats_at, free_share, goes_on):
    fake = Fake(beats_at, free_share=free_share)
    monkeypatch.setattr(pulse, 'Stopwatch', fake.stopwatch)
    monkeypatch.setattr(pulse.student, 'times_raised', lambda name: 0)

    def refuse(*_, **__):
        raise Inconclusive('its parameter services do not answer')

    monkeypatch.setattr(pulse, 'SimulatedClock', refuse)
    recorder = SimpleNamespace(received=fake.received, publishers=lambda: ('/ik_client',))
    assert pulse.Pulse(fake, recorder).goes_on() is goes_on
