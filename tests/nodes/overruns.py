"""Works for 0.25 s in each callback of its 5 Hz timer: it sends four messages a second."""

import time

from five_hz import FiveHz, spin


class Overruns(FiveHz):
    def publish(self):
        super().publish()
        time.sleep(0.25)


def main():
    spin(Overruns)


if __name__ == '__main__':
    main()
