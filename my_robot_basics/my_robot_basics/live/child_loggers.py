"""Unregister the child loggers of a node with that node, so that its successor's stay registered.

rclpy does so when such a logger is collected as garbage, by its name alone. By then a node of the
same name may have one, whose lines reach `/rosout` no more: an action server's, say, after a cell
was run again.
"""

from weakref import WeakKeyDictionary

from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node

_nodes: WeakKeyDictionary[RcutilsLogger, str] = WeakKeyDictionary()
"""Each child logger, and the name of the node's logger from which it comes, directly or not."""


def remember_child_loggers() -> None:
    """Note each child logger that is made from now on."""
    get_child = RcutilsLogger.get_child

    def get_noted_child(logger: RcutilsLogger, name: str) -> RcutilsLogger:
        child = get_child(logger, name)
        if logger.name:  # a node's own logger is a child of the root, which has none
            _nodes[child] = _nodes.get(logger, logger.name)
        return child

    RcutilsLogger.get_child = get_noted_child  # type: ignore[method-assign]


def unregister_child_loggers(node: Node) -> None:
    """Take the child loggers of a node, and their children, off `/rosout`."""
    for child, name in list(_nodes.items()):
        if name == node.get_logger().name:
            child.__del__()  # does nothing a second time
