"""Prints its solutions, which no other node can read."""

from five_hz import spin
from ik_solver import IKSolver


class IKPrints(IKSolver):
    def report(self, solutions):
        print(solutions, flush=True)


def main():
    spin(IKPrints)


if __name__ == '__main__':
    main()
