"""Which nodes live in this ROS domain besides those of `live`."""

import gc
import time
from collections.abc import Iterator

from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

MEETING_SEC = 0.3
"""How long a new participant looks around before it is sure to know the nodes that were there."""


class Neighbours:
    """Looks at the graph through a small node of its own, in rclpy's default context."""

    def __init__(self) -> None:
        self._observer: Node | None = None

    def look_around(self) -> None:
        """Meet the domain's other participants, once per context."""
        if self._observer is not None and not self._observer.context.ok():
            self.leave()
        if self._observer is None:
            self._observer = Node(
                '_live',
                use_global_arguments=False,
                enable_rosout=False,
                start_parameter_services=False,
            )
            time.sleep(MEETING_SEC)

    def leave(self) -> None:
        """Take the observer away."""
        if self._observer is not None:
            self._observer.destroy_node()
            self._observer = None

    def has(self, name: str) -> bool:
        """Whether a node of that fully qualified name lives."""
        # a node that another thread of this process has just made is not on the graph yet
        return any(node.get_fully_qualified_name() == name for node in _nodes_here()) or name in {
            f'{namespace.rstrip("/")}/{node_name}'
            for node_name, namespace in self._observer.get_node_names_and_namespaces()
        }


def bury_the_dead() -> None:
    """Destroy nodes whose context was shut down: they are of no use, but still on the graph."""
    for node in _nodes_here(alive=False):
        node.destroy_node()


def _nodes_here(*, alive: bool = True) -> Iterator[Node]:
    """Nodes of this process that are not destroyed, in a live context or in a dead one."""
    for thing in gc.get_objects():
        if issubclass(type(thing), Node):
            try:
                with thing.handle:
                    right = thing.context.ok() is alive
            except (InvalidHandle, AttributeError):
                continue  # destroyed, or still in its constructor
            if right:
                yield thing
