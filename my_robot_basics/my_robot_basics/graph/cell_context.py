"""One DDS participant for all watchers of a cell: discovery takes a new one 0.3 s each time.

It ends with the cell: the next one may be the student's. An idle node keeps it: rmw ends a
participant with the last node of its context.
"""

import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions

from my_robot_basics.session import kernel

KEEPER = '_keeper'
_keepers: dict[int, Node] = {}
"""The idle node for each ROS domain; its context is the shared one."""
_watched: list[object] = []


def new_context(domain_id: int) -> Context:
    """A new context in that ROS domain; the caller must shut it down."""
    context = Context()
    rclpy.init(
        args=[],
        context=context,
        domain_id=domain_id,
        signal_handler_options=SignalHandlerOptions.NO,
    )
    return context


def context_of_cell(domain_id: int) -> Context | None:
    """The context shared by the present cell's watchers; None outside a kernel."""
    shell = kernel.shell()
    if shell is None:
        return None
    if shell not in _watched:
        shell.events.register('post_execute', _end)
        _watched.append(shell)
    # a signal handler of the student's rclpy.init() shuts all contexts of the process down
    if not all(keeper.context.ok() for keeper in _keepers.values()):
        _end()
    if domain_id not in _keepers:
        _keepers[domain_id] = _keeper(new_context(domain_id))
    return _keepers[domain_id].context


def _keeper(context: Context) -> Node:
    return Node(
        KEEPER,
        context=context,
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
        parameter_overrides=[Parameter('start_type_description_service', value=False)],
    )


def _end() -> None:
    while _keepers:
        keeper = _keepers.popitem()[1]
        keeper.destroy_node()
        keeper.context.try_shutdown()
