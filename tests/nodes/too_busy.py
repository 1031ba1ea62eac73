"""Computes for 0.25 s in each callback of its 5 Hz timer, and so reaches 4 Hz."""

import time

from five_hz import FiveHz, spin


class TooBusy(FiveHz):
    def publish(self):
        super().publish()
        time.sleep(0.25)


def main():
    spin(TooBusy)


if __name__ == '__main__':
    main()
