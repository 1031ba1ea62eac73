"""Logs whole degrees: not within 0.01 of the angles."""

from five_hz import spin
from ik_solver import IKSolver


class IKCoarse(IKSolver):
    def report(self, solutions):
        self.get_logger().info(str([round(a) for pair in solutions.values() for a in pair]))


def main():
    spin(IKCoarse)


if __name__ == '__main__':
    main()
