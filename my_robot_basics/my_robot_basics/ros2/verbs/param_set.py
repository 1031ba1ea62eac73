"""Set parameter."""

import argparse

from my_robot_basics.ros2 import parameters
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parameters.add_one_parameter(parser)
    parser.add_argument('value', help='Value of the parameter')


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    import yaml
    from rcl_interfaces.msg import Parameter
    from rclpy.parameter import get_parameter_value

    try:
        value = get_parameter_value(args.value)
    except (yaml.YAMLError, ValueError, OverflowError, RecursionError) as error:
        raise CommandError(f'The passed value is not YAML: {error}') from None
    with Graph(args) as graph:
        parameter = Parameter(name=args.parameter_name, value=value)
        [result] = parameters.services_of(graph, args).set(parameter)
    parameters.say_result(result, 'Set parameter successful', 'Setting parameter failed')
