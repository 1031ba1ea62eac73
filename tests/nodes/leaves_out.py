"""Logs every 20th time in place of publishing."""

from five_hz import FiveHz, spin


class LeavesOut(FiveHz):
    def publish(self):
        self.calls = getattr(self, 'calls', 0) + 1
        if self.calls % 20 == 0:
            self.get_logger().info(f'{self.calls} messages')
        else:
            super().publish()


if __name__ == '__main__':
    spin(LeavesOut)
