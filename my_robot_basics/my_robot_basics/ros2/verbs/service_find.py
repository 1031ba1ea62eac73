"""Output a list of available services of a given type."""

import argparse

from my_robot_basics.ros2 import arguments, completion, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'service_type',
        completer=completion.service_types,
        help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/"
        "ListParameters')",
    )
    names_and_types.add_count(parser, 'service')
    arguments.add_hidden_services(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        services = graph.services(include_hidden=args.include_hidden_services)
    names_and_types.print_with_type(services, args.service_type, count=args.count)
