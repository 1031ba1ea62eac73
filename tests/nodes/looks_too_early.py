"""Checks every 10 ms whether 0.17 s have passed on its clock, which is 5.88 Hz."""

from five_hz import FiveHz, spin


class LooksTooEarly(FiveHz):
    def start(self, period_sec):
        self.last = self.get_clock().now()
        self.timer = self.create_timer(period_sec / 20, self.look)

    def look(self):
        now = self.get_clock().now()
        if (now - self.last).nanoseconds >= 170_000_000:
            self.last = now
            self.publish()


def main():
    spin(LooksTooEarly)


if __name__ == '__main__':
    main()
