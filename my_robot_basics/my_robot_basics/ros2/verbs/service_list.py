"""Output a list of available services."""

import argparse

from my_robot_basics.ros2 import arguments, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    names_and_types.add_list_options(parser, 'service')
    arguments.add_hidden_services(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        services = graph.services(include_hidden=args.include_hidden_services)
    names_and_types.print_list(services, count=args.count, show_types=args.show_types)
