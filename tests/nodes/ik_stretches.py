"""Warns of a target out of reach, but also logs the pose of an arm stretched towards it."""

from math import atan2, degrees

from five_hz import spin
from ik_solver import IKSolver


class IKStretches(IKSolver):
    def solve(self, point):
        super().solve(point)
        bearing_deg = degrees(atan2(point.y, point.x))
        self.get_logger().info(f'stretched: θ1={bearing_deg:.2f}°, θ2=0.00°')


def main():
    spin(IKStretches)


if __name__ == '__main__':
    main()
