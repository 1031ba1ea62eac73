"""Publishes from a thread that sleeps by `create_rate(5)`."""

import threading

from five_hz import FiveHz, spin


class CreateRate(FiveHz):
    def start(self, period_sec):
        self.rate = self.create_rate(1 / period_sec)
        threading.Thread(target=self.loop, daemon=True).start()

    def loop(self):
        while self.context.ok():
            self.publish()
            self.rate.sleep()


def main():
    spin(CreateRate)


if __name__ == '__main__':
    main()
