"""Raises an exception in the timer's callback, which ends the executor."""

from five_hz import FiveHz, spin


class CallbackRaises(FiveHz):
    def publish(self):
        raise ValueError('no pose')


def main():
    spin(CallbackRaises)


if __name__ == '__main__':
    main()
