"""Warns of a target out of reach, but also logs its last answer again."""

from five_hz import spin
from ik_solver import IKSolver


class IKClings(IKSolver):
    def solve(self, point):
        self.is_answered = False
        super().solve(point)
        if not self.is_answered:
            self.report(self.last)

    def report(self, solutions):
        self.is_answered, self.last = True, solutions
        super().report(solutions)


def main():
    spin(IKClings)


if __name__ == '__main__':
    main()
