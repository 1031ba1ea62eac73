"""Output a list of available topics of a given type."""

import argparse

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.offer(
        parser.add_argument(
            'topic_type',
            help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')",
        ),
        completion.message_types,
    )
    parser.add_argument(
        '-c',
        '--count-topics',
        action='store_true',
        help='Only display the number of topics discovered',
    )
    arguments.add_hidden_topics(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        topics = graph.topics(include_hidden=args.include_hidden_topics)
    found = [name for name, types in topics if args.topic_type in types]
    if args.count_topics:
        print(len(found))
    else:
        for name in found:
            print(name)
