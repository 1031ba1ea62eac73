"""Print a topic's type."""

import argparse

from my_robot_basics.ros2 import arguments, completion, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'topic_name',
        completer=completion.topic_names,
        help="Name of the ROS topic to get type (e.g. '/chatter')",
    )


def main(args: argparse.Namespace) -> int:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        topics = graph.topics(include_hidden=args.include_hidden_topics)
    return names_and_types.print_types(topics, args.topic_name)
