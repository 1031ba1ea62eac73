"""Keeps the last target, and logs its solutions or its warning again on each tick of a timer."""

from five_hz import spin
from ik_solver import IKSolver


class IKRepeats(IKSolver):
    def __init__(self):
        super().__init__()
        self.target = None
        self.create_timer(0.05, self.repeat)

    def solve(self, point):
        self.target = point

    def repeat(self):
        if self.target is not None:
            super().solve(self.target)


def main():
    spin(IKRepeats)


if __name__ == '__main__':
    main()
