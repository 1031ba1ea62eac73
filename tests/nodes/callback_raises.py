"""Raises in the timer's callback: its executor dies of it."""

from five_hz import FiveHz, spin


class CallbackRaises(FiveHz):
    def publish(self):
        raise ValueError('no pose')


def main():
    spin(CallbackRaises)


if __name__ == '__main__':
    main()
