"""Stamps every message with the time of its construction."""

from five_hz import FiveHz, spin


class OneStamp(FiveHz):
    def start(self, period_sec):
        self.stamp = self.get_clock().now().to_msg()
        super().start(period_sec)

    def joint_state(self):
        message = super().joint_state()
        message.header.stamp = self.stamp
        return message


def main():
    spin(OneStamp)


if __name__ == '__main__':
    main()
