"""Output messages from a topic."""

import argparse
import math
from typing import TYPE_CHECKING, Any

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.expressions import message_filter
from my_robot_basics.ros2.graph import Graph

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

DEFAULT_TRUNCATE_LENGTH = 128


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'topic_name',
        completer=completion.topic_names,
        help="Name of the ROS topic to listen to (e.g. '/chatter')",
    )
    completion.add_argument(
        parser,
        'message_type',
        completer=completion.topic_types,
        nargs='?',
        help="Type of the ROS message (e.g. 'std_msgs/msg/String')",
    )
    arguments.add_qos(parser, 'subscribe', 'sensor_data')
    parser.add_argument(
        '--csv',
        action='store_true',
        help='Output all recursive fields separated by commas (e.g. for plotting). '
        'If --include-message-info is also passed, the following fields are prepended: '
        'source_timestamp, received_timestamp, publication_sequence_number, '
        'reception_sequence_number.',
    )
    parser.add_argument(
        '--field',
        help="Echo a selected field of a message. Use '.' to select sub-fields. For example, "
        'to echo the position field of a nav_msgs/msg/Odometry message: '
        "'ros2 topic echo /odom --field pose.pose.position'",
    )
    parser.add_argument(
        '--full-length',
        '-f',
        action='store_true',
        help="Output all elements for arrays, bytes, and string with a length > '--truncate-"
        "length', by default they are truncated after '--truncate-length' elements with '...'",
    )
    parser.add_argument(
        '--truncate-length',
        '-l',
        type=arguments.unsigned_int,
        default=DEFAULT_TRUNCATE_LENGTH,
        help='The length to truncate arrays, bytes, and string to (default: %(default)s)',
    )
    flags = {
        '--no-arr': "Don't print array fields of messages",
        '--no-str': "Don't print string fields of messages",
        '--flow-style': 'Print arrays on one line (not available with csv format)',
        '--no-lost-messages': "Don't report when a message is lost",
        '--raw': 'Echo the raw binary representation',
        '--once': 'Print the first message received and then exit.',
    }
    for flag, text in flags.items():
        parser.add_argument(flag, action='store_true', help=text)
    parser.add_argument(
        '--filter',
        dest='filter_expr',
        help='Python expression to filter messages that are printed. Expression can use Python '
        'builtins as well as m (the message).',
    )
    parser.add_argument(
        '--timeout',
        metavar='N',
        type=arguments.positive_float,
        default=math.inf,
        help='Set a timeout in seconds for waiting',
    )
    parser.add_argument(
        '--include-message-info',
        '-i',
        action='store_true',
        help='Shows the associated message info.',
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        # imported here, while discovery goes on in the background
        from my_robot_basics.ros2 import qos

        echo = Echo(args)
        graph.settle()
        profile = qos.for_publishers(graph.publishers_of(args.topic_name), args)
        echo.subscribe(graph, _message_class(graph, args), profile)
        graph.spin_until(lambda: args.once and echo.has_printed, timeout_sec=args.timeout)


class Echo:
    """Prints the messages of a topic, in the format that the arguments choose."""

    def __init__(self, args: argparse.Namespace) -> None:
        from my_robot_basics.ros2.as_text import Shortening

        self.has_printed = False
        self._args = args
        self._fields = [name for name in (args.field or '').split('.') if name]
        if args.field is not None and not self._fields:
            raise CommandError(f"Invalid field value '{args.field}'")
        self._is_wanted = message_filter(args.filter_expr)
        length = None if args.full_length else args.truncate_length
        self._shortening = Shortening(length, args.no_arr, args.no_str)

    def subscribe(self, graph: Graph, message_class: Any, profile: 'QoSProfile') -> None:
        """Subscribe to the topic."""
        from rclpy.event_handler import SubscriptionEventCallbacks

        events = None
        if not self._args.no_lost_messages:
            events = SubscriptionEventCallbacks(message_lost=_report_loss)
        graph.subscribe(
            message_class,
            self._args.topic_name,
            self._on_message,
            profile,
            event_callbacks=events,
            raw=self._args.raw,
        )

    def _on_message(self, message: Any, info: dict[str, int]) -> None:
        if self._args.once and self.has_printed:
            return
        part = self._selected(message)
        if self._is_wanted(part):
            self._print(part, info)
            self.has_printed = True

    def _selected(self, message: Any) -> Any:
        for name in self._fields:
            try:
                message = getattr(message, name)
            except AttributeError as error:
                path = '.'.join(self._fields)
                raise CommandError(f"Invalid field '{path}': {error}") from None
        return message

    def _print(self, part: Any, info: dict[str, int]) -> None:
        import yaml

        from my_robot_basics.ros2.as_text import as_csv, as_yaml

        with_info = self._args.include_message_info
        if not hasattr(part, '__slots__'):  # bytes, or a field that is not a message
            if with_info:
                print('---Got new message, message info:---', info, sep='\n')
                print('---Message data:---')
            print(part, end='\n---\n')
        elif self._args.csv:
            cells = [*info.values()] if with_info else []
            print(*cells, as_csv(part, self._shortening), sep=',')
        else:
            if with_info:
                print(yaml.dump(info), end='---\n')
            flow_style = self._args.flow_style
            print(as_yaml(part, self._shortening, flow_style=flow_style), end='---\n')


def _message_class(graph: Graph, args: argparse.Namespace) -> Any:
    from my_robot_basics.ros2.interfaces import message_class

    if args.message_type is None:
        found, complaint = graph.message_class(args.topic_name), 'Could not determine the type '
        complaint += 'for the passed topic'
    else:
        found, complaint = message_class(args.message_type), 'The passed message type is invalid'
    if found is None:
        raise CommandError(complaint)
    return found


def _report_loss(status: Any) -> None:
    print(
        f'A message was lost!!!\n\ttotal count change:{status.total_count_change}'
        f'\n\ttotal count: {status.total_count}',
        end='---\n',
    )
