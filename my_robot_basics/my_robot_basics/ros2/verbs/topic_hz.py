"""Print the average publishing rate to screen."""

import argparse
import math
from collections import deque
from collections.abc import Callable

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.expressions import message_filter
from my_robot_basics.ros2.graph import Graph

DEFAULT_WINDOW_SIZE = 10000
SECOND_NSEC = 10**9


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'topic_name',
        completer=completion.topic_names,
        help="Name of the ROS topic to listen to (e.g. '/chatter')",
    )
    parser.add_argument(
        '--window',
        '-w',
        dest='window_size',
        metavar='WINDOW',
        type=arguments.positive_int,
        default=DEFAULT_WINDOW_SIZE,
        help='window size, in # of messages, for calculating rate (default: %(default)s)',
    )
    parser.add_argument(
        '--filter',
        dest='filter_expr',
        metavar='EXPR',
        help='only measure messages matching the specified Python expression',
    )
    parser.add_argument(
        '--wall-time',
        dest='use_wtime',
        action='store_true',
        help='calculates rate using wall time which can be helpful when clock is not published '
        'during simulation',
    )
    arguments.add_discovery(parser, daemon=False)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    is_wanted = message_filter(args.filter_expr)
    with Graph(args) as graph:
        from rclpy.clock import Clock, ClockType
        from rclpy.qos import qos_profile_sensor_data

        clock = (
            Clock(clock_type=ClockType.SYSTEM_TIME) if args.use_wtime else graph.node.get_clock()
        )
        rate = Rate(lambda: clock.now().nanoseconds, window_size=args.window_size)
        graph.settle()
        message_class = graph.message_class(args.topic_name, wait=True)
        graph.subscribe(
            message_class,
            args.topic_name,
            lambda message: rate.arrival() if is_wanted(message) else None,
            qos_profile_sensor_data,
        )
        graph.spin()


class Rate:
    """Records arrivals, and prints their statistics once a second of its clock."""

    def __init__(self, now_nsec: Callable[[], int], *, window_size: int) -> None:
        self._now_nsec = now_nsec
        self._gaps_nsec: deque[int] = deque(maxlen=window_size)
        self._last: int | None = None
        self._printed: int | None = None

    def arrival(self) -> None:
        """Record a message that arrives now, and print the statistics when a second is over."""
        now = self._now_nsec()
        if now == 0:  # simulated time before its first tick
            if self._gaps_nsec:
                print('time has reset, resetting counters')
                self._gaps_nsec.clear()
            return
        if self._last is None or now < self._last:
            self._gaps_nsec.clear()
            self._last = now
            return
        self._gaps_nsec.append(now - self._last)
        self._last = now
        if self._printed is None or now < self._printed:
            self._printed = now
        elif now >= self._printed + SECOND_NSEC:
            self._printed = now
            print(self._statistics())

    def _statistics(self) -> str:
        gaps_sec = [gap / SECOND_NSEC for gap in self._gaps_nsec]
        mean = sum(gaps_sec) / len(gaps_sec)
        rate_hz = 1.0 / mean if mean > 0.0 else 0.0
        deviation = math.sqrt(sum((gap - mean) ** 2 for gap in gaps_sec) / len(gaps_sec))
        return (
            f'average rate: {rate_hz:.3f}\n'
            f'\tmin: {min(gaps_sec):.3f}s max: {max(gaps_sec):.3f}s '
            f'std dev: {deviation:.5f}s window: {len(gaps_sec)}'
        )
