"""Long recordings on the robot's clock: one tick a message shows what short steps show."""

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from my_robot_basics.checks import topic
from my_robot_basics.checks.clock.clock import SimulatedClock
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.topics import drives
from my_robot_basics.checks.topics.driven_topic import DrivenTopic
from nodes.running import running

SECONDS, STEP_SEC = 60.0, 0.1
FEW_TICKS = 370
"""100 ticks in ten seconds, 250 messages in fifty, and some before the recording begins."""


class Driven:
    """A topic on which timers publish, as rcl calls them: once a tick."""

    def __init__(self, *timers, in_long_ticks=True):
        self.timers = [
            {'period': period, 'next': period * 0.7, 'calls': 0} for period, _ in timers
        ]
        self.publish = [publish for _, publish in timers]
        self.in_long_ticks = in_long_ticks
        self.ticks = 0
        self.recorder = SimpleNamespace(received=[], topic_name='/t', publishers=lambda: ('/n',))
        self.recorder.hidden_publishers = tuple
        self.clock = SimpleNamespace(now_ns=0, time_ns=int, takes_long=lambda: False)

    def tick(self, step_ns):
        """Move the clock; return how many messages came."""
        self.ticks += 1
        now_ns = self.clock.now_ns = self.clock.now_ns + step_ns
        before = len(self.recorder.received)
        for timer, publish in zip(self.timers, self.publish, strict=True):
            if now_ns >= timer['next']:
                late = (now_ns - timer['next']) // timer['period']
                timer['next'] += (late + 1) * timer['period']
                timer['calls'] += 1
                if publish(timer['calls'], now_ns / 1e9):
                    self.recorder.received.append((None, now_ns))
        return len(self.recorder.received) - before

    def tick_to_message(self, step_ns):
        """Return after how many ticks a message came."""
        return next(n for n in itertools.count(1) if self.tick(step_ns))

    def expect_in_each_tick(self, step_ns):
        """Whether long ticks are tried."""
        return self.in_long_ticks

    def expect_keeps_up(self, ticks, step_ns):
        """Do nothing: no callback takes long."""


def every_call(call, sec):
    return True


def drive(*timers, **options):
    """Return a recording, and how many ticks it took."""
    driven = Driven(*[(round(period * 1e9), publish) for period, publish in timers], **options)
    return drives.drive(driven, seconds=SECONDS, step_sec=STEP_SEC), driven.ticks


@pytest.mark.parametrize('period_sec', [0.2, 0.5, 1.0, 2.0])
def test_a_plain_timer_needs_few_ticks(period_sec):
    found, ticks = drive((period_sec, every_call))
    assert ticks <= 150 + SECONDS / period_sec
    assert (found.step_sec, found.seconds) == (STEP_SEC, SECONDS)
    np.testing.assert_allclose(
        rates.times_of(found), period_sec * np.arange(SECONDS / period_sec + 1), atol=1e-9
    )


@pytest.mark.parametrize(
    'timers',
    {
        'counts_two_calls': [(0.1, lambda call, sec: call % 2 == 0)],
        'leaves_out_the_sixtieth': [(0.2, lambda call, sec: call % 60 != 0)],
        'stops': [(0.2, lambda call, sec: sec < 25.0)],
        'pauses': [(0.2, lambda call, sec: sec % 25.0 < 22.0)],
        'another_timer_begins': [(0.2, every_call), (0.3, lambda call, sec: sec > 30.0)],
        'becomes_slower': [(0.05, lambda call, sec: call % (4 if sec < 20.0 else 6) == 0)],
        'one_percent_fast': [(0.198, every_call)],
        'half_a_percent_slow': [(0.201, every_call)],
        'six_hertz': [(1 / 6, every_call)],
    }.items(),
    ids=lambda named: named[0],
)
def test_what_is_not_a_plain_timer_looks_as_in_short_steps(timers):
    found, ticks = drive(*timers[1])
    expected, _ = drive(*timers[1], in_long_ticks=False)
    assert ticks > FEW_TICKS
    assert rates.is_even(found) == rates.is_even(expected)
    assert rates.leaves_out(found) == rates.leaves_out(expected)
    assert found.is_over == expected.is_over
    assert rates.has_rate(found, 5.0) == rates.has_rate(expected, 5.0)


@pytest.mark.parametrize('period_sec', [0.204, 0.198, 1 / 6, 0.35])
def test_messages_that_are_not_equally_far_apart_are_recorded_in_short_steps(period_sec):
    found, ticks = drive((period_sec, every_call))
    expected, most = drive((period_sec, every_call), in_long_ticks=False)
    assert ticks == most
    assert rates.times_of(found).tolist() == rates.times_of(expected).tolist()


@pytest.mark.starts
@pytest.mark.usefixtures('patient')
def test_a_minute_of_a_node_needs_few_ticks(monkeypatch):
    tick, steps_sec = DrivenTopic.tick, []

    def note_and_tick(driven, step_ns):
        steps_sec.append(step_ns / 1e9)
        return tick(driven, step_ns)

    monkeypatch.setattr(DrivenTopic, 'tick', note_and_tick)
    monkeypatch.setattr(SimulatedClock, 'takes_long', lambda clock: False)
    with running('five_hz'):
        found = topic('/kinematics/joint_states').record(seconds=SECONDS)
        found.assert_rate(hz=5.0)
    assert len(found.messages) == 300
    assert steps_sec.count(0.2) >= 250
    assert len(steps_sec) < 500
