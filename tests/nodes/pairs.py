"""Two messages every 0.4 s: the nearest to 5 Hz that bursts can be."""

from five_hz import FiveHz, spin


class Pairs(FiveHz):
    def __init__(self, **kwargs):
        super().__init__(period_sec=0.4, **kwargs)

    def publish(self):
        for _ in range(2):
            super().publish()


def main():
    spin(Pairs)


if __name__ == '__main__':
    main()
