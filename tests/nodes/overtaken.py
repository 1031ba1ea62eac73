"""Answers a request now and then before it takes the tick that was sent earlier.

On a busy machine, any executor does: a wait that begins while both arrive may see only one.
"""

import contextlib
import random

import rclpy
from five_hz import FiveHz
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

OFTEN = 0.3
"""In which part of its waits the executor does not look at the clock, never twice in a row."""


class Overtaken(FiveHz):
    pass


class LeavesClock(SingleThreadedExecutor):
    """Leaves the subscription to /clock out of some waits, which then end with a request."""

    leaves_it = False

    def _wait_for_ready_callbacks(self, *args, **options):
        self.leaves_it = not self.leaves_it and random.random() < OFTEN
        yield from super()._wait_for_ready_callbacks(*args, **options)

    def can_execute(self, entity):
        is_clock = getattr(entity, 'topic_name', '') == '/clock'
        return not (is_clock and self.leaves_it) and super().can_execute(entity)


def main():
    random.seed(0)
    rclpy.init()
    executor = LeavesClock()
    executor.add_node(Overtaken())
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == '__main__':
    main()
