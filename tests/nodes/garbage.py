"""Publishes, at 5 Hz, bytes that are not a valid message."""

from five_hz import FiveHz, spin


class Garbage(FiveHz):
    def publish(self):
        self.publisher.publish(b'\x00\x01\x00\x00' + b'\xff' * 60)


def main():
    spin(Garbage)


if __name__ == '__main__':
    main()
