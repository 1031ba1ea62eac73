"""Actions on the graph: which nodes are servers or clients of each action, and of which type."""

from rclpy.action import get_action_names_and_types
from rclpy.node import Node

from my_robot_basics.graph.services import ServiceGraph, take_servers_and_clients


def take_graph(node: Node) -> ServiceGraph:
    """The actions as a node sees them now."""
    names = [name for name, _ in get_action_names_and_types(node)]
    return take_servers_and_clients(node, {name: f'{name}/_action/send_goal' for name in names})
