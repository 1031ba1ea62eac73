"""Five messages once a second: as many as at 5 Hz, but unevenly."""

from five_hz import FiveHz, spin


class Bursts(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=1.0, **kwargs)

    def publish(self):
        for _ in range(5):
            super().publish()


def main():
    spin(Bursts)


if __name__ == '__main__':
    main()
