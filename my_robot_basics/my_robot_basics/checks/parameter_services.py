"""Nodes that can be asked for their parameters, and `use_sim_time` among these."""

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rclpy.node import Node

from my_robot_basics.graph.watcher import HIDDEN


def use_sim_time(value: bool) -> Parameter:
    """The parameter with that value."""
    kind = ParameterType.PARAMETER_BOOL
    return Parameter(name='use_sim_time', value=ParameterValue(type=kind, bool_value=value))


def nodes_with_services(node: Node) -> set[str]:
    """Full names of the nodes on the graph whose parameters can be set, but the course's own."""
    suffix = '/set_parameters'
    services = [name for name, _ in node.get_service_names_and_types()]
    names = {name.removesuffix(suffix) for name in services if name.endswith(suffix)}
    return {name for name in names if not name.rpartition('/')[2].startswith(HIDDEN)}
