"""End a node with all that it has made."""

from types import SimpleNamespace

from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from my_robot_basics.live.child_loggers import unregister_child_loggers


def destroy(node: Node) -> None:
    """Destroy a node, its action servers, its action clients and its child loggers.

    `destroy_node` leaves these: they keep the node on the graph, and the server goes on there,
    until nobody refers to them any more.
    """
    for waitable in list(node.waitables):
        if isinstance(waitable, ActionServer | ActionClient):
            waitable.destroy()
    unregister_child_loggers(node)
    # where rclpy's own constructor has raised, this one is missing, and destroy_node would raise
    # an error of its own in place of that one
    vars(node).setdefault('_type_description_service', SimpleNamespace(destroy=lambda: None))
    node.destroy_node()
