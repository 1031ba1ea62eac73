"""Load parameter file for a node."""

import argparse
from typing import Any

from my_robot_basics.ros2 import parameters
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parameters.add_node(parser)
    parser.add_argument('parameter_file', help='Parameter file')
    parser.add_argument(
        '--no-use-wildcard',
        action='store_true',
        help="Do not load parameters in the '/**' namespace into the node",
    )


def main(args: argparse.Namespace) -> None:
    """Run the verb."""
    with Graph(args) as graph:
        services = parameters.services_of(graph, args)
        loaded = _read(args.parameter_file, use_wildcard=not args.no_use_wildcard)
        results = services.set(*loaded)
    for parameter, result in zip(loaded, results, strict=True):
        words = f'Set parameter {parameter.name}'
        parameters.say_result(result, f'{words} successful', f'{words} failed')


def _read(path: str, *, use_wildcard: bool) -> list[Any]:
    """Return the rcl_interfaces Parameters in a file; raises RuntimeError for an invalid file.

    As in Jazzy's rclpy, it returns the parameters of all nodes in the file.
    """
    import yaml
    from rclpy.parameter import parameter_dict_from_yaml_file

    try:
        return list(parameter_dict_from_yaml_file(path, use_wildcard).values())
    except OSError as error:
        raise CommandError(str(error)) from None
    except (yaml.YAMLError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise CommandError(f'{path} is not a valid ROS parameter file: {error}') from None
