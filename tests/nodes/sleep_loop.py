"""Publishes from a `time.sleep(0.2)` loop in a thread, while the node spins."""

import threading
import time

from five_hz import FiveHz, spin


class SleepLoop(FiveHz):
    def start(self, period_sec):
        self.period_sec = period_sec
        threading.Thread(target=self.loop, daemon=True).start()

    def loop(self):
        while self.context.ok():
            self.publish()
            time.sleep(self.period_sec)


def main():
    spin(SleepLoop)


if __name__ == '__main__':
    main()
