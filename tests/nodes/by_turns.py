"""Publishes alternately 0.1 s and 0.3 s after the last message: 5 a second, but unevenly."""

from five_hz import FiveHz, spin


class ByTurns(FiveHz):
    def start(self, period_sec):
        self.calls = 0
        super().start(period_sec / 2)

    def publish(self):
        self.calls += 1
        if self.calls % 4 < 2:
            super().publish()


if __name__ == '__main__':
    spin(ByTurns)
