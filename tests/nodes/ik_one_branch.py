"""Logs one of the two solutions."""

from five_hz import spin
from ik_solver import IKSolver


class IKOneBranch(IKSolver):
    def report(self, solutions):
        self.get_logger().info(str(solutions['elbow_down']))


def main():
    spin(IKOneBranch)


if __name__ == '__main__':
    main()
