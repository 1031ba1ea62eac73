"""The course's own nodes are to be read and run in lessons; no answer is made of them.

An answer may call the course's functions, such as those of `two_link_kinematics`. Where its node
derives from one of the package, takes a method of it, or makes one, it is told so.
"""

import importlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from types import FunctionType

from rclpy.node import Node

from my_robot_basics.live.patching import patch, patched
from my_robot_basics.session.errors import NotRunnable

MODULES = tuple(
    f'my_robot_basics.{name}'
    for name in ('hello_node', 'kinematics_node', 'kinematics_publisher', 'kinematics_subscriber')
)
HOW = 'write your own in the answer cell; the functions of two_link_kinematics may be called'


def taken_from(answer: type) -> str:
    """What a node class has of the course's own nodes, as the end of a sentence; or ''."""
    for base in answer.__mro__:
        if base.__module__ in MODULES:
            return f'one that derives from {base.__module__}.{base.__name__}'
        for name, attribute in vars(base).items():
            function = getattr(attribute, '__func__', attribute)
            if isinstance(function, FunctionType) and function.__module__ in (*MODULES, __name__):
                return f"one whose {name} is that of the course's {function.__qualname__}"
    return ''


@contextmanager
def none_made() -> Iterator[None]:
    """Nobody makes one of the course's nodes meanwhile."""
    with ExitStack() as stack:
        for NodeClass in _classes():
            stack.enter_context(patched(NodeClass, '__init__', _refusal(NodeClass)))
        yield


def close() -> None:
    """Let nobody make one any more, derive from one, or use a method: a notebook is graded."""
    for NodeClass in _classes():
        refuse = _refusal(NodeClass)
        for name, attribute in [*vars(NodeClass).items()]:
            if isinstance(attribute, FunctionType):
                patch(NodeClass, name, refuse)
        patch(NodeClass, '__init_subclass__', classmethod(refuse))


def _classes() -> list[type[Node]]:
    modules = [importlib.import_module(name) for name in MODULES]
    return [
        thing
        for module in modules
        for thing in vars(module).values()
        if isinstance(thing, type) and thing.__module__ == module.__name__
        if issubclass(thing, Node)
    ]


def _refusal(NodeClass: type[Node]) -> Callable[..., None]:
    def refuse(*_: object, **__: object) -> None:
        name = NodeClass.__name__
        raise NotRunnable(f"expected a node of your own, saw the course's {name}: {HOW}")

    refuse.__qualname__ = NodeClass.__qualname__
    return refuse
