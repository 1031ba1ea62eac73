"""Output a list of available services of a given type."""

import argparse

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    completion.offer(
        parser.add_argument(
            'service_type',
            help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/"
            "ListParameters')",
        ),
        completion.service_types,
    )
    parser.add_argument(
        '-c',
        '--count-services',
        action='store_true',
        help='Only display the number of services discovered',
    )
    arguments.add_hidden_services(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        graph.settle()
        services = graph.services(include_hidden=args.include_hidden_services)
    found = [name for name, types in services if args.service_type in types]
    if args.count_services:
        print(len(found))
    else:
        for name in found:
            print(name)
