"""Display bandwidth used by topic."""

import argparse
import sys
from collections import deque
from collections.abc import Callable

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.graph import Graph

DEFAULT_WINDOW_SIZE = 100
UNITS = ((1, 'B', 0), (1000, 'KB', 2), (1000_000, 'MB', 2))
"""For each unit: bytes, name, decimals."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'topic_name',
        completer=completion.topic_names,
        metavar='topic',
        help='Topic name to monitor for bandwidth utilization',
    )
    parser.add_argument(
        '--window',
        '-w',
        metavar='WINDOW',
        type=arguments.positive_int,
        default=DEFAULT_WINDOW_SIZE,
        help='maximum window size, in # of messages, for calculating rate (default: %(default)s)',
    )
    arguments.add_discovery(parser, daemon=False)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        from rclpy.qos import qos_profile_sensor_data

        clock = graph.node.get_clock()
        bandwidth = Bandwidth(lambda: clock.now().nanoseconds, window_size=args.window)
        graph.settle()
        message_class = graph.message_class(args.topic_name, wait=True)
        graph.subscribe(
            message_class,
            args.topic_name,
            lambda data: bandwidth.arrival(len(data)),
            qos_profile_sensor_data,
            raw=True,
        )
        print(f'Subscribed to [{args.topic_name}]')
        graph.node.create_timer(1.0, bandwidth.print)
        graph.spin()


class Bandwidth:
    """Collects the sizes of messages, and prints their bandwidth."""

    def __init__(self, now_nsec: Callable[[], int], *, window_size: int) -> None:
        self._now_nsec = now_nsec
        self._arrivals: deque[tuple[int, int]] = deque(maxlen=window_size)

    def arrival(self, size_bytes: int) -> None:
        """Record a message that arrives now."""
        self._arrivals.append((self._now_nsec(), size_bytes))

    def print(self) -> None:
        """Print the bandwidth of the messages in the window, if there are at least two."""
        if len(self._arrivals) < 2:
            return
        passed_sec = (self._now_nsec() - self._arrivals[0][0]) / 1e9
        if passed_sec <= 0.0:
            print('WARNING: time is reset!', file=sys.stderr)
            self._arrivals.clear()
            return
        sizes = [size for _, size in self._arrivals]
        rate = sum(sizes) / passed_sec
        divisor, unit, decimals = max(u for u in UNITS if rate >= u[0] or u[0] == 1)
        numbers = (rate, sum(sizes) / len(sizes), min(sizes), max(sizes))
        rate_text, mean, least, most = (f'{n / divisor:.{decimals}f} {unit}' for n in numbers)
        print(
            f'{rate_text}/s from {len(sizes)} messages\n'
            f'\tMessage size mean: {mean} min: {least} max: {most}'
        )
