"""The names and parameters that a command line gives a node, as rcl reads it. Nothing starts."""

from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.context import Context
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

from my_robot_basics.ros2.command_line import (
    OPTIONS_OF_FILES,
    OPTIONS_OF_PARAMETERS,
    OPTIONS_OF_RULES,
    CommandLine,
)
from my_robot_basics.session import classroom
from my_robot_basics.session.environment import set_meanwhile

_REFUSED = (RuntimeError, ValueError, ParameterException)
"""What rclpy raises for invalid names, rules and parameters."""


@dataclass(frozen=True)
class StartedNode:
    """What a node was like that was created for a moment with the command line's options."""

    name: str
    """The full name, such as '/left/arm'."""
    topic_name: str
    """The full name that the program's topic has after the remap rules."""
    parameter: Any
    """The value of the parameter; None if no option sets it."""
    has_file: bool
    """Whether the command line also names a parameter file, which is not read here."""


def started_node(
    line: CommandLine, *, node_name: str, topic_name: str, parameter_name: str
) -> StartedNode | None:
    """Apply a command line to a program with this node, topic and parameter.

    None if rcl refuses the command line.
    """
    options = line.options(*OPTIONS_OF_RULES, *OPTIONS_OF_PARAMETERS)
    arguments = ['--ros-args', *(word for pair in options for word in pair)]
    domain_id, context = classroom.enter(), Context()
    try:
        with _discovery_off():
            rclpy.init(
                args=arguments,
                context=context,
                domain_id=domain_id,
                signal_handler_options=SignalHandlerOptions.NO,
            )
            node = Node(
                node_name,
                context=context,
                enable_rosout=False,
                start_parameter_services=False,
                parameter_overrides=[Parameter('start_type_description_service', value=False)],
            )
    except _REFUSED:
        context.try_shutdown()
        return None
    try:
        any_type = ParameterDescriptor(dynamic_typing=True)
        parameter = node.declare_parameter(parameter_name, None, any_type).value
        return StartedNode(
            node.get_fully_qualified_name(),
            node.resolve_topic_name(topic_name) if topic_name else '',
            parameter,
            has_file=bool(line.options(*OPTIONS_OF_FILES)),
        )
    except _REFUSED:
        return None
    finally:
        node.destroy_node()
        context.shutdown()


def _discovery_off() -> AbstractContextManager[None]:
    """Participants created inside this context neither discover others nor are discovered."""
    return set_meanwhile('ROS_AUTOMATIC_DISCOVERY_RANGE', 'OFF')
