"""What `run` says to what it cannot run."""

from types import ModuleType

from rclpy.node import Node


def not_a_class(thing: object) -> str:
    """Words for what is no node class."""
    if isinstance(thing, Node):
        name = type(thing).__name__
        return f'run expects the class, saw a node made from it: write run({name})'
    if isinstance(thing, ModuleType):
        name = thing.__name__.rpartition('.')[2]
        return f'run expects a class, saw the module {name}: write run({name}.…), with its class'
    return f'run expects a class derived from rclpy.node.Node, saw {thing!r:.80}'


def no_node_yet(NodeClass: type[Node]) -> str:
    """Words for a constructor that uses the node before there is one, or never makes it."""
    return (
        f'expected the constructor of {NodeClass.__name__} to begin with '
        "super().__init__('its_name'), saw it use the node before that, or leave it out"
    )


def is_made(node: Node) -> bool:
    """Whether rclpy's own constructor has made the node."""
    return getattr(node, 'handle', None) is not None
