"""Delete parameter."""

import argparse

from my_robot_basics.ros2 import parameters
from my_robot_basics.ros2.graph import Graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the verb's arguments."""
    parameters.add_one_parameter(parser)


def main(args: argparse.Namespace) -> None:
    """Run the verb: a parameter is deleted by setting it to PARAMETER_NOT_SET."""
    from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue

    nothing = ParameterValue(type=ParameterType.PARAMETER_NOT_SET)
    with Graph(args) as graph:
        parameter = Parameter(name=args.parameter_name, value=nothing)
        [result] = parameters.services_of(graph, args).set(parameter)
    parameters.say_result(result, 'Deleted parameter successfully', 'Deleting parameter failed')
