"""Answers, and warns of every target."""

from five_hz import spin
from ik_solver import IKSolver


class IKAlwaysWarns(IKSolver):
    def report(self, solutions):
        super().report(solutions)
        self.get_logger().warning('careful')


def main():
    spin(IKAlwaysWarns)


if __name__ == '__main__':
    main()
