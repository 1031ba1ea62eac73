"""The steps of the robot's clock that are found for a recording: they hide no call of a timer."""

from types import SimpleNamespace

import pytest
from made_recordings import recording
from my_robot_basics.checks.recordings import rates
from my_robot_basics.checks.topics import drives

MESSAGES = 40


class PlainTimer:
    """A topic whose node publishes in each call of one timer, as rcl calls it: once a tick."""

    def __init__(self, hz: float, phase: float) -> None:
        self.period_ns = round(1e9 / hz)
        self.next_ns = round(phase * self.period_ns)
        self.clock = SimpleNamespace(now_ns=0)

    def tick_to_message(self, step_ns: int) -> int:
        """Move the clock until the timer is due; return in how many steps."""
        for ticks in range(1, 10_000):
            self.clock.now_ns += step_ns
            if self.clock.now_ns >= self.next_ns:
                late_ns = self.clock.now_ns - self.next_ns
                self.next_ns += (late_ns // self.period_ns + 1) * self.period_ns
                return ticks
        raise AssertionError('the timer never fires')

    def times_sec(self, step_ns: int) -> list[float]:
        """When the next messages come, since now."""
        start_ns, times_sec = self.clock.now_ns, []
        for _ in range(MESSAGES):
            self.tick_to_message(step_ns)
            times_sec.append((self.clock.now_ns - start_ns) / 1e9)
        return times_sec


@pytest.mark.parametrize('hz', [0.5, 5.0, 7.0, 7.5, 8.0, 9.0, 12.5, 15.0, 16.0, 17.0, 40.0, 80.0])
@pytest.mark.parametrize('step_sec', [0.1, 0.05])
def test_the_chosen_steps_show_each_plain_timer_as_even_and_complete(hz, step_sec):
    """With 8 Hz in steps of 0.1 s, one gap of four is two ticks long, and the others are one."""
    for phase in range(20):
        timer = PlainTimer(hz, phase / 20)
        step_ns, _ = drives._find_step(timer, step_sec=step_sec)
        times_sec = timer.times_sec(step_ns)
        seen = recording(times_sec, seconds=times_sec[-1], step_sec=step_ns / 1e9)
        assert rates.leaves_out(seen) == 0, phase
        assert rates.is_even(seen), phase
