"""Nodes with parameter services, and their parameter `use_sim_time`."""

from collections.abc import Mapping

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.client import Client
from rclpy.node import Node
from rclpy.task import Future

from my_robot_basics.graph.watcher import HIDDEN


def use_sim_time(value: bool) -> Parameter:
    """The parameter use_sim_time with that value, as a message."""
    kind = ParameterType.PARAMETER_BOOL
    return Parameter(name='use_sim_time', value=ParameterValue(type=kind, bool_value=value))


def set_use_sim_time(
    setters: Mapping[str, Client], values: Mapping[str, bool]
) -> dict[str, Future]:
    """Ask each of these nodes to set use_sim_time; return the futures by the nodes' names."""
    return {
        name: setters[name].call_async(SetParameters.Request(parameters=[use_sim_time(value)]))
        for name, value in values.items()
    }


def is_refused(asked: Future) -> bool:
    """Whether a node has answered that it refuses a value."""
    return asked.done() and not all(result.successful for result in asked.result().results)


def nodes_with_services(node: Node) -> set[str]:
    """Full names of the nodes on the graph whose parameters can be set, without the course's."""
    suffix = '/set_parameters'
    services = [name for name, _ in node.get_service_names_and_types()]
    names = {name.removesuffix(suffix) for name in services if name.endswith(suffix)}
    return {name for name in names if not name.rpartition('/')[2].startswith(HIDDEN)}
