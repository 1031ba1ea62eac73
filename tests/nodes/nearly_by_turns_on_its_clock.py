"""Publishes alternately 0.15 s and 0.25 s after the last message, by the robot's clock."""

from five_hz import spin
from nearly_by_turns import NearlyByTurns


class OnItsClock(NearlyByTurns):
    def start(self, period_sec):
        self.calls = 0
        self.timer = self.create_timer(period_sec / 4, self.publish)


if __name__ == '__main__':
    spin(OnItsClock)
