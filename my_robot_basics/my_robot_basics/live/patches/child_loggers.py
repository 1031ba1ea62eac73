"""Unregister a node's child loggers together with the node, so that its successor's are kept.

rclpy unregisters such a logger, by its name, when it is garbage-collected. By then, a new node of
the same name may have registered that name: its lines would no longer reach `/rosout`. This
happens to the logger of an action server, for example, after a cell was run again.
"""

from weakref import WeakKeyDictionary

from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node

_nodes: WeakKeyDictionary[RcutilsLogger, str] = WeakKeyDictionary()
"""The name of the node's logger from which each child logger is derived, directly or not."""


def remember_child_loggers() -> None:
    """Record each child logger that is created from now on."""
    get_child = RcutilsLogger.get_child

    def get_noted_child(logger: RcutilsLogger, name: str) -> RcutilsLogger:
        child = get_child(logger, name)
        if logger.name:  # a node's own logger is a child of the root logger, whose name is empty
            _nodes[child] = _nodes.get(logger, logger.name)
        return child

    RcutilsLogger.get_child = get_noted_child  # type: ignore[method-assign]


def unregister_child_loggers(node: Node) -> None:
    """Remove a node's child loggers, and their children, from `/rosout`.

    Do nothing for a node that a cell has destroyed itself: its handle no longer has their name.
    """
    if not node.handle.pointer:
        return
    logger_name = node.handle.logger_name()  # a student's class may have overwritten its logger
    for child, name in list(_nodes.items()):
        if name == logger_name:
            child.__del__()  # a second call does nothing
