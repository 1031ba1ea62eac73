"""Logs both solutions on one line, by a child of its logger, in whole turns, with its thoughts."""

from five_hz import spin
from ik_solver import IKSolver


class IKOneLine(IKSolver):
    def report(self, solutions):
        (a1, a2), (b1, b2) = solutions.values()
        answer = f'2 solutions: {a1 + 360:.4f} {a2:.4f} and {b1:.4f} {b2 - 360:.4f}'
        self.get_logger().get_child('answers').info(answer)


def main():
    spin(IKOneLine)


if __name__ == '__main__':
    main()
