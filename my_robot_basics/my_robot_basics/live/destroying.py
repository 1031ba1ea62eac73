"""End a node with all that it has made."""

from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node


def destroy(node: Node) -> None:
    """Destroy a node, its action servers and its action clients.

    `destroy_node` leaves these: they keep the node on the graph, and the server goes on there,
    until nobody refers to them any more.
    """
    for waitable in list(node.waitables):
        if isinstance(waitable, ActionServer | ActionClient):
            waitable.destroy()
    node.destroy_node()
