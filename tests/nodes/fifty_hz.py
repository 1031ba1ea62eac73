"""Publishes at 50 Hz, faster than the clock's first step."""

from five_hz import FiveHz, spin


class FiftyHz(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=0.02, **kwargs)


def main():
    spin(FiftyHz)


if __name__ == '__main__':
    main()
