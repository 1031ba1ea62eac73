"""Two messages every 0.4 s: no other bursts come as close to 5 Hz."""

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
