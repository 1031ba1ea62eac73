"""Publishes at 50 Hz, more often than the first step of the simulated clock."""

from five_hz import FiveHz, spin


class FiftyHz(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=0.02, **kwargs)


def main():
    spin(FiftyHz)


if __name__ == '__main__':
    main()
