"""Publishes alternately 0.15 s and 0.25 s after the last message, and ignores /clock."""

from five_hz import FiveHz, spin
from rclpy.clock import Clock, ClockType


class NearlyByTurns(FiveHz):
    def start(self, period_sec):
        self.calls = 0
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.timer = self.create_timer(period_sec / 4, self.publish, clock=clock)

    def publish(self):
        self.calls += 1
        if self.calls % 8 in (0, 3):
            super().publish()


if __name__ == '__main__':
    spin(NearlyByTurns)
