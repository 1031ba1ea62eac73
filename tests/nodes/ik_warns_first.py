"""Warns of every target, and then answers."""

from five_hz import spin
from ik_solver import IKSolver


class IKWarnsFirst(IKSolver):
    def report(self, solutions):
        self.get_logger().warning('careful')
        super().report(solutions)


def main():
    spin(IKWarnsFirst)


if __name__ == '__main__':
    main()
