"""Warns of a target out of reach in two records, the second a little later."""

import time

from five_hz import spin
from geometry_msgs.msg import Point
from ik_solver import IKSolver


class IKWarnsTwice(IKSolver):
    def solve(self, point: Point):
        super().solve(point)
        if abs(point.x) > 2.0:
            time.sleep(0.15)
            self.get_logger().warning('I stay where I am')


def main():
    spin(IKWarnsTwice)


if __name__ == '__main__':
    main()
