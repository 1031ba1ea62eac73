"""Publishes at 5.25 Hz: a near miss."""

from five_hz import FiveHz, spin


class TooFast(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=1 / 5.25, **kwargs)


def main():
    spin(TooFast)


if __name__ == '__main__':
    main()
