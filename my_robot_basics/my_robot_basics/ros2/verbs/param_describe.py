"""Show descriptive information about declared parameters."""

import argparse
from typing import Any

from my_robot_basics.ros2 import completion, parameters
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parameters.add_node(parser)
    completion.add_argument(
        parser,
        'parameter_names',
        completer=parameters.parameter_names,
        nargs='+',
        help='Names of the parameters',
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb; as in ros2cli, it describes nothing if one of the names is not declared."""
    with Graph(args) as graph:
        descriptors = parameters.services_of(graph, args).descriptors(args.parameter_names)
    for descriptor in descriptors:
        _print(descriptor)


def _print(descriptor: Any) -> None:
    print('Parameter name:', descriptor.name)
    print('  Type:', parameters.type_names()[descriptor.type])
    if descriptor.description:
        print('  Description:', descriptor.description)
    print('  Constraints:')
    if descriptor.read_only:
        print('    Read only: true')
    for range_ in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
        print('    Min value:', range_.from_value)
        print('    Max value:', range_.to_value)
        if range_.step:
            print('    Step:', range_.step)
    if descriptor.additional_constraints:
        print('    Additional constraints:', descriptor.additional_constraints)
