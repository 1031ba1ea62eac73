"""Publish a message to a topic."""

import argparse
import sys
from typing import Any

from my_robot_basics.ros2 import arguments, completion, typed_values
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph

REPORT_SEC = 1.0
TAKEN_SEC = 5.0
"""How long subscriptions may take to acknowledge the last message; most need a millisecond."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'topic_name',
        completer=completion.topic_names,
        help="Name of the ROS topic to publish to (e.g. '/chatter')",
    )
    completion.add_argument(
        parser,
        'message_type',
        completer=completion.topic_types,
        help="Type of the ROS message (e.g. 'std_msgs/String')",
    )
    source = parser.add_mutually_exclusive_group()
    completion.add_argument(
        source,
        'values',
        completer=completion.prototype,
        nargs='?',
        default='{}',
        help="Values to fill the message with in YAML format (e.g. 'data: Hello World'), "
        'otherwise the message will be published with default values',
    )
    source.add_argument('--stdin', action='store_true', help='Read values from standard input')
    parser.add_argument(
        '-r',
        '--rate',
        metavar='N',
        type=arguments.positive_float,
        default=1.0,
        help='Publishing rate in Hz (default: 1)',
    )
    parser.add_argument(
        '-p',
        '--print',
        metavar='N',
        type=arguments.any_int,
        default=1,
        help='Only print every N-th published message (default: 1)',
    )
    number = parser.add_mutually_exclusive_group()
    number.add_argument('-1', '--once', action='store_true', help='Publish one message and exit')
    number.add_argument(
        '-t',
        '--times',
        type=arguments.unsigned_int,
        default=0,
        help='Publish this number of times and then exit',
    )
    parser.add_argument(
        '-w',
        '--wait-matching-subscriptions',
        type=arguments.unsigned_int,
        help='Wait until finding the specified number of matching subscriptions. '
        'Defaults to 1 when using "-1"/"--once"/"--times", otherwise defaults to 0.',
    )
    parser.add_argument(
        '--max-wait-time-secs',
        type=arguments.positive_float,
        help='This sets the maximum wait time in seconds if --wait-until-matching-subscriptions '
        'is set. By default, this flag is not set meaning the subscriber will wait endlessly.',
    )
    parser.add_argument(
        '--keep-alive',
        metavar='N',
        type=arguments.positive_float,
        default=0.1,
        help='Keep publishing node alive for N seconds after the last msg (default: 0.1)',
    )
    parser.add_argument('-n', '--node-name', help='Name of the created publishing node')
    arguments.add_qos(parser, 'publish', 'default')
    arguments.add_discovery(parser, daemon=False)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    from my_robot_basics.ros2 import qos
    from my_robot_basics.ros2.fill import BadValue, fill_to_publish
    from my_robot_basics.ros2.interfaces import message_class_for

    times = 1 if args.once else args.times
    wanted = args.wait_matching_subscriptions
    wanted = int(times != 0) if wanted is None else wanted
    if wanted == 0 and args.max_wait_time_secs is not None:
        raise CommandError(
            '--max-wait-time-secs option is only effective '
            'with --wait-matching-subscriptions, --once or --times'
        )
    message = message_class_for(args.message_type)()
    values = typed_values.parse(sys.stdin.buffer.read() if args.stdin else args.values)
    if not isinstance(values, dict):
        raise CommandError('The passed value needs to be a dictionary in YAML format')
    try:
        stamp_setters = fill_to_publish(message, values)
    except BadValue as error:
        raise CommandError(f'Failed to populate field: {error}') from None

    with Graph(args, node_name=args.node_name) as graph:
        from rclpy.duration import Duration

        publisher = graph.advertise(type(message), args.topic_name, qos.profile(args))
        if wanted == 0:
            graph.settle()  # subscriptions that exist already get the first message, too
        _wait_for_subscriptions(graph, publisher, wanted, args.max_wait_time_secs)
        print('publisher: beginning loop')
        count = 0

        def publish() -> None:
            nonlocal count
            stamp = graph.node.get_clock().now().to_msg()
            for set_stamp in stamp_setters:
                set_stamp(stamp)
            count += 1
            if args.print and count % args.print == 0:
                print(f'publishing #{count}: {message!r}\n')
            publisher.publish(message)

        publish()
        if times != 1:
            graph.node.create_timer(1.0 / args.rate, publish)
            graph.spin_until(lambda: 0 < times <= count)
        # a discovered subscription may not have discovered this publisher yet: wait for its
        # acknowledgement, else the message is lost
        graph.wait_until(lambda: publisher.wait_for_all_acked(Duration()), timeout_sec=TAKEN_SEC)
        graph.sleep(args.keep_alive)


def _wait_for_subscriptions(
    graph: Graph, publisher: Any, wanted: int, most_sec: float | None
) -> None:
    def are_there() -> bool:
        return publisher.get_subscription_count() >= wanted

    waited_sec = 0.0
    while not are_there():
        print(f'Waiting for at least {wanted} matching subscription(s)...')
        left_sec = REPORT_SEC if most_sec is None else min(REPORT_SEC, most_sec - waited_sec)
        if graph.wait_until(are_there, timeout_sec=left_sec):
            return
        waited_sec += left_sec
        if most_sec is not None and waited_sec >= most_sec:
            raise CommandError(
                f'Timed out waiting for subscribers: Expected {wanted} subcribers '
                f'but only got {publisher.get_subscription_count()} subscribers'
            )
