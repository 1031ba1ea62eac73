"""Output a list of available parameters."""

import argparse
import re

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph
from my_robot_basics.ros2.parameters import ParameterServices, absolute, type_names


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser,
        'node_name',
        completer=completion.node_names,
        nargs='?',
        help='Name of the ROS node',
    )
    parser.add_argument(
        '--filter',
        help='Only parameters matching the regex expression will be showed. '
        'Supports `re` regex syntax.',
    )
    parser.add_argument(
        '--include-hidden-nodes', action='store_true', help='Consider hidden nodes as well'
    )
    parser.add_argument(
        '--param-prefixes',
        nargs='+',
        default=[],
        help='Only list parameters with the provided prefixes',
    )
    parser.add_argument(
        '--param-type', action='store_true', help='Print parameter types with parameter names'
    )


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    try:
        pattern = re.compile(args.filter or '')
    except (re.error, RecursionError, OverflowError) as error:
        raise CommandError(f'--filter: not a regex: {args.filter!r} ({error})') from None
    with Graph(args) as graph:
        graph.settle()
        nodes = graph.nodes(include_hidden=args.include_hidden_nodes)
        names = sorted({node.full_name for node in nodes})
        if args.node_name:
            names = [name for name in names if name == absolute(args.node_name)]
            if not names:
                return 'Node not found'
        for name in names:
            try:
                services = ParameterServices(graph, name)
                _print(services, name, pattern, args)
            except CommandError as error:
                print(error)
    return None


def _print(
    services: ParameterServices, node_name: str, pattern: re.Pattern, args: argparse.Namespace
) -> None:
    names = [name for name in services.names(args.param_prefixes) if pattern.match(name)]
    if names and not args.node_name:
        print(f'{node_name}:')
    types = services.types(names) if args.param_type else {}
    for name in names:
        print(f'  {name} (type: {type_names()[types[name]]})' if types else f'  {name}')
