"""Find an attribute of rclpy's Node that a student's class has given a value of its own."""

from pathlib import Path

import rclpy
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.context import Context
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node
from rclpy.parameter import Parameter

_RCLPY = str(Path(rclpy.__file__).parent)
_KINDS: dict[str, type] = {
    **dict.fromkeys(('_publishers', '_subscriptions', '_clients', '_services', '_timers'), list),
    '_parameters': dict,
    '_descriptors': dict,
    '_clock': Clock,
    '_logger': RcutilsLogger,
    '_context': Context,
    '_default_callback_group': CallbackGroup,
}
"""Attributes that rclpy needs, and what it keeps there; a student may know none of them."""


def overwritten_attribute(node: Node) -> str:
    """Return an attribute of rclpy's own in which the node has something else, or ''."""
    have = vars(node)
    if other := next((n for n, kind in _KINDS.items() if not isinstance(have.get(n), kind)), ''):
        return other
    is_ours = all(isinstance(each, Parameter) for each in have['_parameters'].values())
    return '' if is_ours else '_parameters'


def spoils_rclpy(node: Node, error: BaseException) -> str:
    """Return the attribute that made rclpy itself raise in the node's constructor, or ''."""
    step = error.__traceback__
    while step is not None and step.tb_next is not None:
        step = step.tb_next
    is_in_rclpy = step is not None and step.tb_frame.f_code.co_filename.startswith(_RCLPY)
    return overwritten_attribute(node) if is_in_rclpy else ''
