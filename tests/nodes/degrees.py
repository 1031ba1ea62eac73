"""Publishes degrees instead of radians."""

from five_hz import FiveHz, spin


class Degrees(FiveHz):
    def joint_state(self):
        message = super().joint_state()
        message.position = [23.4, -67.8]
        return message


def main():
    spin(Degrees)


if __name__ == '__main__':
    main()
