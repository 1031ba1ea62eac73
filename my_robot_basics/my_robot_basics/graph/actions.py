"""Actions on the graph: which nodes serve one, which send goals, and with which type."""

from functools import partial

from rclpy.action import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import Node

from my_robot_basics.graph.services import ServiceGraph, take_ends


def take(node: Node) -> ServiceGraph:
    """The actions as a node sees them now."""
    return take_ends(
        node,
        partial(get_action_server_names_and_types_by_node, node),
        partial(get_action_client_names_and_types_by_node, node),
    )
