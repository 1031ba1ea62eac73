"""End a node with all that it has made."""

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
    node.destroy_node()
