"""Publishes at 4.75 Hz: a near miss."""

from five_hz import FiveHz, spin


class TooSlow(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=1 / 4.75, **kwargs)


def main():
    spin(TooSlow)


if __name__ == '__main__':
    main()
