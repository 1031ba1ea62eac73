"""Print information about a service."""

import argparse

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'service_name',
        completer=completion.service_names,
        help="Name of the ROS service to get info (e.g. '/add_two_ints')",
    )


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    name = args.service_name
    with Graph(args) as graph:
        graph.settle()
        services = dict(graph.services(include_hidden=args.include_hidden_services))
        if (types := services.get(name)) is None:
            return f"Unknown service '{name}'"
        print('Type:', types[0] if len(types) == 1 else types)
        print('Clients count:', graph.node.count_clients(name))
        print('Services count:', graph.node.count_services(name))
    return None
