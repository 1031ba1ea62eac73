"""The error messages of `run` about classes that it cannot run."""

import inspect
from types import FunctionType, ModuleType

from rclpy.node import Node

from my_robot_basics.session.errors import NotRunnable

_OWN = sorted(n for n in dir(Node) if isinstance(vars(Node).get(n), property))
_UNUSED = 'publishers'
"""The only property of Node that no executor reads: a node spins even if it is overridden."""
_METHODS = (FunctionType, staticmethod, classmethod)
"""What must not override a property of Node; another property or value may."""


def expect_runnable(NodeClass: object) -> None:
    """Raise NotRunnable if it is not a class of nodes that rclpy can spin.

    rclpy puts nodes into sets, so they have to be hashable. At each spin, it reads the properties
    of Node, so a node with a method in place of one would raise again and again.
    """
    __tracebackhide__ = True
    if not (isinstance(NodeClass, type) and issubclass(NodeClass, Node)):
        raise NotRunnable(not_a_class(NodeClass))
    if NodeClass.__hash__ is None:
        raise NotRunnable(
            f'expected {NodeClass.__name__} to have no `__eq__` of its own, saw one: rclpy could '
            'not put its nodes into a set, so remove `@dataclass` above the class, or that method'
        )
    hidden = (
        name
        for name in _OWN
        if name != _UNUSED and isinstance(inspect.getattr_static(NodeClass, name), _METHODS)
    )
    if name := next(hidden, ''):
        raise NotRunnable(
            f'expected {NodeClass.__name__} to have no method `{name}`, saw one: `Node` already '
            'has an attribute of this name, and uses it, so choose another name'
        )


def not_a_class(thing: object) -> str:
    """Return the message about an argument that is not a node class."""
    if isinstance(thing, Node):
        name = type(thing).__name__
        return f'run expects the class, saw a node made from it: write run({name})'
    if isinstance(thing, ModuleType):
        name = thing.__name__.rpartition('.')[2]
        return f'run expects a class, saw the module {name}: write run({name}.…), with its class'
    return f'run expects a class derived from rclpy.node.Node, saw {thing!r:.80}'


def no_node_yet(NodeClass: type[Node]) -> str:
    """Return the message about a constructor that does not call Node's constructor first."""
    return (
        f'expected the constructor of {NodeClass.__name__} to begin with '
        "super().__init__('its_name'), saw it use the node before that, or leave it out"
    )


def has_overwritten(NodeClass: type[Node], attribute: str) -> str:
    """Return the message about a constructor that gave one of Node's attributes a value."""
    return (
        f'expected {NodeClass.__name__} to leave `self.{attribute}` alone, saw it assigned: '
        '`Node` already has an attribute of this name, and uses it, so choose another name'
    )


def is_made(node: Node) -> bool:
    """Whether Node's constructor has created the node."""
    return getattr(node, 'handle', None) is not None
