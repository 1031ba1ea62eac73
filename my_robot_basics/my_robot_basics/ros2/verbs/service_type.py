"""Output a service's type."""

import argparse

from my_robot_basics.ros2 import completion, names_and_types
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.add_argument(
        parser,
        'service_name',
        completer=completion.service_names,
        help="Name of the ROS service to get type (e.g. '/talker/list_parameters')",
    )


def main(args: argparse.Namespace) -> int:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        services = graph.services(include_hidden=args.include_hidden_services)
    return names_and_types.print_types(services, args.service_name)
