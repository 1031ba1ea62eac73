"""Publishes at 1 Hz instead of 5 Hz."""

from five_hz import FiveHz, spin


class OneHz(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=1.0, **kwargs)


def main():
    spin(OneHz)


if __name__ == '__main__':
    main()
