"""Output a list of action names."""

import argparse

from my_robot_basics.ros2 import names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    names_and_types.add_list_options(parser, 'action')


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        actions = graph.actions()
    names_and_types.print_list(actions, count=args.count, show_types=args.show_types)
