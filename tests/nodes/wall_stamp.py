"""Stamps with the system's time, not the node's clock."""

from five_hz import FiveHz, spin
from rclpy.clock import Clock, ClockType


class WallStamp(FiveHz):
    def joint_state(self):
        message = super().joint_state()
        message.header.stamp = Clock(clock_type=ClockType.SYSTEM_TIME).now().to_msg()
        return message


def main():
    spin(WallStamp)


if __name__ == '__main__':
    main()
