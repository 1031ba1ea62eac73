"""Computes for 0.1 s in each callback of its 5 Hz timer: slow to answer, but right."""

import time

from five_hz import FiveHz, spin


class BusyCallback(FiveHz):
    def publish(self):
        super().publish()
        time.sleep(0.1)


def main():
    spin(BusyCallback)


if __name__ == '__main__':
    main()
