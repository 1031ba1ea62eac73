"""Print a action's type."""

import argparse

from my_robot_basics.ros2 import completion, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'action_name',
        completer=completion.action_names,
        help="Name of the ROS action to get info (e.g. '/fibonacci')",
    )


def main(args: argparse.Namespace) -> int:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        actions = graph.actions()
    return names_and_types.print_types(actions, args.action_name)
