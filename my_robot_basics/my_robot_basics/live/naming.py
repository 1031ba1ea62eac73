"""Know a node's name before the node exists: its constructor alone can tell."""

import functools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node

from my_robot_basics.live.patching import patched


@contextmanager
def announce_name(node: Node, on_name: Callable[[str], None]) -> Iterator[None]:
    """Call `on_name` with the fully qualified name of `node` just before rclpy makes the node.

    What `on_name` raises ends the constructor there and then: no second node of a name is made,
    not even for a moment (destroying it would silence the first one's /rosout).
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
