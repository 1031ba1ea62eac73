"""Record exceptions of a node's callbacks, and find callbacks that do not return."""

import sys
import sysconfig
import time
import traceback
from pathlib import Path

import rclpy
from rclpy.node import Node

from my_robot_basics.exchange.wire import THREADS
from my_robot_basics.live.output import failed_calls
from my_robot_basics.live.output.wrong_arguments import how_to_make
from my_robot_basics.session.errors import without_signatures
from my_robot_basics.session.neighbours import nodes_here

UNFINISHED_SEC = 0.5
_last: dict[str, str] = {}
"""The last exception of a node's callbacks, by the node's full name."""
_raised_ns: dict[str, int] = {}
"""When a node's callbacks have raised last, as `time.monotonic_ns()`."""
_fields: dict[str, tuple[str, str]] = {}
"""What `unpublished_field` returns, by the node's full name."""
_of_services: dict[tuple[str, str], str] = {}
"""The last exception of a service's callback, by the node's and the service's full names."""
_NOT_THEIRS = (str(Path(rclpy.__file__).parent), str(Path(__file__).parents[1]))
_OF_A_LIBRARY = (
    *(sysconfig.get_path(kind) for kind in ('stdlib', 'purelib', 'platlib')),
    f'{Path(__file__).parents[2]}/',
)
"""Folders of code that a student calls, the course's own too: the line of the call says more."""


def where_and_what(error: BaseException) -> tuple[str, str]:
    """Return where the error happened, outermost call first, and its text."""
    where = '\n'.join(f'  {_line(frame)}' for frame in _frames(error))
    return where, ''.join(traceback.format_exception_only(error)).strip()


def remember(node_name: str, error: BaseException) -> None:
    """Record an exception of the node's callback, or of a thread of the notebook, and its line."""
    _, what = where_and_what(error)
    frames = _frames(error)
    own = [frame for frame in frames if not frame.filename.startswith(_OF_A_LIBRARY)]
    place = _line((own or frames)[-1]) if frames else ''
    what = without_signatures(what)
    told = f'{what} ({place})' if place else what
    _fields[node_name] = failed_calls.unpublished_field(error) or ('', how_to_make(error))
    if node_name != THREADS and (service_name := failed_calls.service_name(error)):
        _of_services[node_name, service_name] = told
    # these two last: a check in another thread that sees them asks for the others at once
    _last[node_name] = told
    _raised_ns[node_name] = time.monotonic_ns()


def forget(node_name: str) -> None:
    """Drop a node's records, and those of threads: a new node of that name is starting."""
    for of_nodes in (_last, _raised_ns, _fields):
        of_nodes.pop(node_name, None)
        of_nodes.pop(THREADS, None)
    for key in [key for key in _of_services if key[0] == node_name]:
        del _of_services[key]


def forget_all() -> None:
    """Drop all records, at the beginning of an exercise."""
    _last.clear()
    _raised_ns.clear()
    _fields.clear()
    _of_services.clear()


def last_raised(node_name: str) -> str:
    """Return the last exception of the node's callbacks, or ''."""
    return _last.get(node_name, '')


def unpublished_field(node_name: str) -> tuple[str, str]:
    """Return the field that kept the node from sending, and its type, for its last exception.

    If it gave rclpy a wrong object instead of a request or goal: '', and how to make one.
    """
    return _fields.get(node_name, ('', ''))


def last_raised_ns(node_name: str) -> int:
    """Return when a callback of the node has raised last, as `time.monotonic_ns()`; 0 if none."""
    return _raised_ns.get(node_name, 0)


def last_raised_in_service(service_name: str) -> dict[str, str]:
    """Return the last exception of a service's callback, by the nodes' full names."""
    return {node: what for (node, name), what in _of_services.items() if name == service_name}


def blocking_line(node_name: str) -> str:
    """Return the line at which a callback blocks all others of the node, or ''.

    It is a callback that is in progress for UNFINISHED_SEC, for which this function waits.
    """
    from my_robot_basics.doctor import inside  # few answers need it

    seen = inside.Inside()
    seen.look()
    time.sleep(UNFINISHED_SEC)
    seen.look()
    lasting = seen.callbacks(at_least_sec=UNFINISHED_SEC)
    return next((each.line for each in lasting if node_name in each.holds and each.line), '')


def line_in_thread(thread_id: int) -> str:
    """Return the innermost line of the student's code that a thread executes; '' if there is none.

    As in a traceback, it is the line of a call if a library executes that call.
    """
    frame = sys._current_frames().get(thread_id)
    stack = traceback.extract_stack(frame) if frame is not None else []
    own = [each for each in stack if not each.filename.startswith(_OF_A_LIBRARY)]
    return _line(own[-1]) if own else ''


def overwritten_attribute(node_name: str) -> str:
    """Return an attribute of rclpy's Node in which a node of this process has its own, or ''."""
    from my_robot_basics.live.output import overwritten  # few answers need it

    return next(map(overwritten.overwritten_attribute, _nodes_of(node_name)), '')


def logger_level(node_name: str) -> int:
    """Return the least severity that the logger of a node of this process logs; 0 if unknown."""
    levels = (int(node.get_logger().get_effective_level()) for node in _nodes_of(node_name))
    return next(levels, 0)


def sleeping_line() -> tuple[int, str]:
    """Return the line at which callbacks sleep most of the time: its number and text; or 0, ''."""
    from my_robot_basics.live.output import sleeping  # few answers need it

    return sleeping.sleeping_line()


def sleeps_on(node_name: str, seconds: float) -> tuple[int, str]:
    """Return the line at which a callback blocks the node and sleeps for `seconds`; or 0, ''."""
    from my_robot_basics.live.output import sleeping  # few answers need it

    return sleeping.sleeps_on(node_name, seconds)


def _nodes_of(node_name: str) -> list[Node]:
    return [node for node in nodes_here() if node.get_fully_qualified_name() == node_name]


def _frames(error: BaseException) -> list[traceback.FrameSummary]:
    return [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if not frame.filename.startswith(_NOT_THEIRS)
    ]


def _line(frame: traceback.FrameSummary) -> str:
    line_number, function_name, code = frame.lineno, frame.name, frame.line
    where = f'line {line_number}, in {function_name}: {code}'
    return ', '.join(filter(None, (_file_name(frame.filename), where)))


def _file_name(filename: str) -> str:
    """Return a file's name for a message; '' for a cell, whose file name is meaningless."""
    path = Path(filename)
    if path.parent.name.startswith('ipykernel_') or filename.startswith('<'):
        return ''
    return path.name
