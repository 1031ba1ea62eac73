"""Leaves the header's stamp at zero."""

from builtin_interfaces.msg import Time
from five_hz import FiveHz, spin


class NoStamp(FiveHz):
    def joint_state(self):
        message = super().joint_state()
        message.header.stamp = Time()
        return message


def main():
    spin(NoStamp)


if __name__ == '__main__':
    main()
