"""A thread that sleeps on the node's clock, and once is late by 10 s of it."""

import threading

from five_hz import FiveHz, spin
from rclpy.duration import Duration

CALLS, LATE = 12, Duration(seconds=10.0)


class LateThread(FiveHz):
    def start(self, period_sec):
        self.period = Duration(seconds=period_sec)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        driven = 0
        while self.context.ok():
            self.get_clock().sleep_for(self.period)
            self.publish()
            driven += self.get_clock().ros_time_is_active
            if driven == CALLS:  # while a check drives the clock, in half a second perhaps
                self.get_clock().sleep_for(LATE)


def main():
    spin(LateThread)


if __name__ == '__main__':
    main()
