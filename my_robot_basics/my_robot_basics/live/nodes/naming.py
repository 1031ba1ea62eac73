"""Get a node's name, which only its constructor knows, before the node is created."""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node

from my_robot_basics.live.patches.patching import patched


@contextmanager
def announce_name(node: Node, on_name: Callable[[str], None]) -> Iterator[None]:
    """Call `on_name` with the fully qualified name of `node` just before rclpy creates the node.

    An exception of `on_name` ends the constructor: so no second node of a name is created, not
    even for a moment (destroying it would stop the first one's log messages on /rosout).
    """
    make = Node.__init__

    @functools.wraps(make)
    def init(self: Node, node_name: str, *args: Any, **kwargs: Any) -> None:
        if self is node:
            namespace = str(kwargs.get('namespace') or '').strip('/')
            on_name('/' + '/'.join(filter(None, [namespace, str(node_name)])))
        make(self, node_name, *args, **kwargs)

    with patched(Node, '__init__', init):
        yield
