"""The parameter services of one node."""

import argparse
import math
import sys
from typing import Any

from my_robot_basics.ros2 import arguments, completion
from my_robot_basics.ros2.errors import CommandError
from my_robot_basics.ros2.graph import Graph

TIMEOUT_SEC = 5.0
"""How long to wait for the services, and then for an answer."""


def absolute(node_name: str) -> str:
    """Return a node's name with its leading slash."""
    return node_name if node_name.startswith('/') else f'/{node_name}'


class ParameterServices:
    """Calls a node's parameter services; raises CommandError if the node does not answer."""

    def __init__(self, graph: Graph, node_name: str) -> None:
        from rclpy.parameter_client import AsyncParameterClient

        self._graph = graph
        self._node_name = node_name
        services = dict(graph.services(include_hidden=True))
        ready = f'{node_name}/list_parameters' in services
        if ready:
            self._client = AsyncParameterClient(graph.node, node_name)
            ready = graph.wait_until(self._client.services_are_ready, timeout_sec=TIMEOUT_SEC)
        if not ready:
            raise CommandError(
                f'Wait for service timed out waiting for parameter services for node {node_name}'
            )

    def names(self, prefixes: list[str] | None = None) -> list[str]:
        """Return the names of the node's parameters, sorted."""
        response = self._answer(self._client.list_parameters(prefixes=prefixes))
        return sorted(response.result.names)

    def values(self, names: list[str]) -> list[Any]:
        """Return each parameter's rcl_interfaces ParameterValue; [] if one is not declared."""
        return self._answer(self._client.get_parameters(names)).values

    def descriptors(self, names: list[str]) -> list[Any]:
        """Return each parameter's rcl_interfaces ParameterDescriptor; [] if one is undeclared."""
        return self._answer(self._client.describe_parameters(names)).descriptors

    def types(self, names: list[str]) -> dict[str, int]:
        """Return the rcl_interfaces ParameterType of each parameter, by name."""
        return {descriptor.name: descriptor.type for descriptor in self.descriptors(names)}

    def set(self, *parameters: Any) -> list[Any]:
        """Set rcl_interfaces Parameters, and return the SetParametersResult of each."""
        return self._answer(self._client.set_parameters(parameters)).results

    def _answer(self, future: Any) -> Any:
        self._graph.spin_until(future.done, timeout_sec=TIMEOUT_SEC)
        if not future.done():
            raise CommandError(
                f'Node {self._node_name} does not answer its parameter services: '
                'see that it spins, and that no callback of its blocks'
            )
        if (response := future.result()) is None:
            raise CommandError(
                'Exception while calling service of node '
                f"'{self._node_name}': {future.exception()}"
            )
        return response


def type_names() -> dict[int, str]:
    """Return the name of each rcl_interfaces ParameterType."""
    from rcl_interfaces.msg import ParameterType

    return {
        ParameterType.PARAMETER_NOT_SET: 'not set',
        ParameterType.PARAMETER_BOOL: 'boolean',
        ParameterType.PARAMETER_INTEGER: 'integer',
        ParameterType.PARAMETER_DOUBLE: 'double',
        ParameterType.PARAMETER_STRING: 'string',
        ParameterType.PARAMETER_BYTE_ARRAY: 'byte array',
        ParameterType.PARAMETER_BOOL_ARRAY: 'boolean array',
        ParameterType.PARAMETER_INTEGER_ARRAY: 'integer array',
        ParameterType.PARAMETER_DOUBLE_ARRAY: 'double array',
        ParameterType.PARAMETER_STRING_ARRAY: 'string array',
    }


def add_node(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of a verb for one node."""
    arguments.add_discovery(parser)
    completion.add_argument(
        parser, 'node_name', completer=completion.node_names, help='Name of the ROS node'
    )
    parser.add_argument(
        '--include-hidden-nodes', action='store_true', help='Consider hidden nodes as well'
    )
    parser.add_argument(
        '--timeout',
        metavar='N',
        type=arguments.any_int,
        default=1,
        help='Wait for N seconds until node becomes available (default %(default)s sec)',
    )


def add_one_parameter(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of a verb for one parameter of one node."""
    add_node(parser)
    completion.add_argument(
        parser, 'parameter_name', completer=parameter_names, help='Name of the parameter'
    )


def parameter_names(parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """Return completions: the parameters of the node that is already on the command line."""
    with Graph(parsed_args) as graph:
        graph.settle()
        return ParameterServices(graph, absolute(parsed_args.node_name)).names()


def services_of(graph: Graph, args: argparse.Namespace) -> ParameterServices:
    """Wait for the node in the arguments; return its services, or raise CommandError."""
    node_name = absolute(args.node_name)
    timeout_sec = math.inf if args.timeout < 0 else args.timeout

    def is_there(within_sec: float) -> bool:
        hidden = args.include_hidden_nodes
        return graph.wait_for_node(node_name, include_hidden=hidden, timeout_sec=within_sec)

    # the timeout begins after discovery, which takes longer on a busy machine
    graph.settle()
    if not is_there(0.0):
        if not is_there(timeout_sec):
            raise CommandError('Node not found')
        graph.settle()
    return ParameterServices(graph, node_name)


def say_result(result: Any, successful: str, failed: str) -> None:
    """Print the result of setting one parameter, with the node's reason, as ros2cli does."""
    reason = f': {result.reason}' if result.reason else ''
    if result.successful:
        print(f'{successful}{reason}')
    else:
        print(f'{failed}{reason}', file=sys.stderr)
