"""Destroy a node with all that it has created."""

from types import SimpleNamespace

from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from my_robot_basics.live.patches.child_loggers import unregister_child_loggers


def destroy(node: Node) -> None:
    """Destroy a node, its action servers, its action clients and its child loggers.

    `destroy_node` does not destroy these: they would keep the node, and its server, on the graph
    until they are garbage-collected.
    """
    for waitable in list(node.waitables):
        if isinstance(waitable, ActionServer | ActionClient):
            waitable.destroy()
    unregister_child_loggers(node)
    # if rclpy's own constructor has raised, this attribute is missing, and destroy_node would
    # replace that exception by another one
    vars(node).setdefault('_type_description_service', SimpleNamespace(destroy=lambda: None))
    node.destroy_node()
