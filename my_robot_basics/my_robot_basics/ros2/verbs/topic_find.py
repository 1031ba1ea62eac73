"""Output a list of available topics of a given type."""

import argparse

from my_robot_basics.ros2 import arguments, completion, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'topic_type',
        completer=completion.message_types,
        help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')",
    )
    names_and_types.add_count(parser, 'topic')
    arguments.add_hidden_topics(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        topics = graph.topics(include_hidden=args.include_hidden_topics)
    names_and_types.print_with_type(topics, args.topic_type, count=args.count)
