"""Publishes at 0.2 Hz, one message in 5 s."""

from five_hz import FiveHz, spin


class FifthHz(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=5.0, **kwargs)


def main():
    spin(FifthHz)


if __name__ == '__main__':
    main()
