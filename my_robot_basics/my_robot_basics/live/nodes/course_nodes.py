"""Refuse answers that use the course's own nodes, which lessons only show and run.

An answer may call the course's functions, such as those of `two_link_kinematics`. It is refused,
with a message, if its node derives from a node of the course or uses one of its methods, or if it
creates such a node or starts its program.
"""

import importlib
import re
import signal
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from types import FunctionType

import psutil
from rclpy.node import Node

from my_robot_basics.live.patches.patching import patch, patched
from my_robot_basics.session.errors import NotRunnable

MODULES = tuple(
    f'my_robot_basics.{name}'
    for name in ('hello_node', 'kinematics_node', 'kinematics_publisher', 'kinematics_subscriber')
)
_PROGRAM = re.compile(
    rf'\bmy_robot_basics[./ ]({"|".join(m.partition(".")[2] for m in MODULES)})\b'
)
"""A program of the course in a command line of `ros2 run`, of its process, or of `python -m`."""
END_SEC = 3.0
"""How long a program has to leave the graph after SIGINT, before it is killed."""
HOW = 'write your own in the answer cell; the functions of two_link_kinematics may be called'


def course_part_of(answer: type) -> str:
    """Return what a node class takes from the course's nodes, as the end of a sentence; or ''."""
    for base in answer.__mro__:
        if base.__module__ in MODULES:
            return f'one that derives from {base.__module__}.{base.__name__}'
        for name, attribute in vars(base).items():
            function = getattr(attribute, '__func__', attribute)
            if isinstance(function, FunctionType) and function.__module__ in (*MODULES, __name__):
                return f"one whose {name} is that of the course's {function.__qualname__}"
    return ''


def programs(*, besides: Collection[psutil.Process]) -> dict[psutil.Process, str]:
    """Return the descendants of this process that run the course's nodes, with the nodes' names.

    The children in `besides` and their descendants are left out: a `ros2 run` among them may
    start its program later.
    """
    found = {}
    for child in set(psutil.Process().children()) - set(besides):
        family = [child]
        with suppress(psutil.Error):  # the child has ended meanwhile
            family += child.children(recursive=True)
        for process in family:
            with suppress(psutil.Error):
                if program := _PROGRAM.search(' '.join(process.cmdline())):
                    found[process] = program[1]
    return found


def end_programs(processes: Collection[psutil.Process]) -> None:
    """Send SIGINT, so that the nodes leave the graph; after END_SEC, kill what still runs."""
    for process in processes:
        with suppress(psutil.Error):
            process.send_signal(signal.SIGINT)
    for process in psutil.wait_procs(processes, timeout=END_SEC)[1]:
        with suppress(psutil.Error):
            process.kill()


@contextmanager
def refuse_course_nodes() -> Iterator[None]:
    """Refuse to create any of the course's nodes meanwhile."""
    with ExitStack() as stack:
        for NodeClass in _classes():
            stack.enter_context(patched(NodeClass, '__init__', _refusal(NodeClass)))
        yield


def refuse_course_nodes_for_good() -> None:
    """Refuse from now on to create such a node, derive from it, or use a method: for grading."""
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
