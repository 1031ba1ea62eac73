"""Get parameter."""

import argparse

from my_robot_basics.ros2 import parameters
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parameters.add_one_parameter(parser)
    parser.add_argument('--hide-type', action='store_true', help='Hide the type information')


def main(args: argparse.Namespace) -> str | None:
    """Run the verb."""
    with Graph(args) as graph:
        values = parameters.services_of(graph, args).values([args.parameter_name])
    if not values:
        return 'Parameter not set'
    from rclpy.parameter import parameter_value_to_python

    value = parameter_value_to_python(values[0])
    value = value.tolist() if hasattr(value, 'tolist') else value
    if args.hide_type:
        print(value)
    elif value is None:
        print('Parameter not set.')
    else:
        kind = parameters.type_names()[values[0].type]
        is_array = kind.endswith(' array')
        label = f'{kind.removesuffix(" array")} {"values are" if is_array else "value is"}:'
        print(label.capitalize(), value)
    return None
