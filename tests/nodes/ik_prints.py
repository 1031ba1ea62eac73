"""Prints its solutions: nobody else on the robot can read that."""

from five_hz import spin
from ik_solver import IKSolver


class IKPrints(IKSolver):
    def report(self, solutions):
        print(solutions, flush=True)


def main():
    spin(IKPrints)


if __name__ == '__main__':
    main()
