"""A timer on a steady clock: 5 Hz, independent of /clock."""

from five_hz import FiveHz, spin
from rclpy.clock import Clock, ClockType


class SteadyClock(FiveHz):
    def start(self, period_sec):
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.timer = self.create_timer(period_sec, self.publish, clock=clock)


def main():
    spin(SteadyClock)


if __name__ == '__main__':
    main()
