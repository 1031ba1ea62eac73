"""What keeps a node from its work: an exception, or a callback that does not return, and where."""

import sysconfig
import time
import traceback
from pathlib import Path
from typing import Any

import rclpy
from rclpy.publisher import Publisher
from rclpy.service import Service

from my_robot_basics.exchange.wire import THREADS
from my_robot_basics.exchange.wrong_fields import wrong_field
from my_robot_basics.live.bare_errors import made_with
from my_robot_basics.session.errors import without_signatures

UNFINISHED_SEC = 0.5
_last: dict[str, str] = {}
"""What a callback of a node raised last, by the node's full name."""
_times: dict[str, int] = {}
"""How often one has raised."""
_fields: dict[str, tuple[str, str]] = {}
"""The field of a message that could not be published, and its type, if that was it."""
_of_services: dict[tuple[str, str], str] = {}
"""What the callback of a service raised last, by the node's and the service's full names."""
_NOT_THEIRS = (str(Path(rclpy.__file__).parent), str(Path(__file__).parent))
_OF_A_LIBRARY = tuple(sysconfig.get_path(kind) for kind in ('stdlib', 'purelib', 'platlib'))


def where_and_what(error: BaseException) -> tuple[str, str]:
    """Return where the error happened, outermost call first, and what it says."""
    where = '\n'.join(f'  {_line(frame)}' for frame in _frames(error))
    return where, ''.join(traceback.format_exception_only(error)).strip()


def remember(node_name: str, error: BaseException) -> None:
    """Note what a callback of the node, or a thread of the notebook's own, raised, and where."""
    _, what = where_and_what(error)
    frames = _frames(error)
    own = [frame for frame in frames if not frame.filename.startswith(_OF_A_LIBRARY)]
    place = _line((own or frames)[-1]) if frames else ''
    what = without_signatures(what)
    told = f'{what} ({place})' if place else what
    _fields[node_name] = _unpublished(error) or ('', made_with(error))
    if node_name != THREADS and (service_name := _service(error)):
        _of_services[node_name, service_name] = told
    # last: a check in another thread that knows of these asks for the others at once
    _last[node_name] = told
    _times[node_name] = times(node_name) + 1


def forget(node_name: str) -> None:
    """Forget it, and what ended threads: a new node of that name begins, and its threads do."""
    for of_nodes in (_last, _times, _fields):
        of_nodes.pop(node_name, None)
        of_nodes.pop(THREADS, None)
    for key in [key for key in _of_services if key[0] == node_name]:
        del _of_services[key]


def forget_all() -> None:
    """Forget what the nodes of all names raised: an exercise begins."""
    _last.clear()
    _times.clear()
    _fields.clear()
    _of_services.clear()


def last(node_name: str) -> str:
    """Return what a callback of the node raised last, or ''."""
    return _last.get(node_name, '')


def field(node_name: str) -> tuple[str, str]:
    """Return the field for which it could not publish, and its type, where it raised that last.

    Where it gave rclpy what is no request or goal, no field, and how to make one.
    """
    return _fields.get(node_name, ('', ''))


def times(node_name: str) -> int:
    """Return how often a callback of the node has raised."""
    return _times.get(node_name, 0)


def of_service(service_name: str) -> dict[str, str]:
    """Return what the callbacks of a service raised last, by their nodes' full names."""
    return {node: what for (node, name), what in _of_services.items() if name == service_name}


def unfinished(node_name: str) -> str:
    """Return where a callback is that keeps all others of the node from running, or ''.

    That is one that goes on for UNFINISHED_SEC, while this looks.
    """
    from my_robot_basics.doctor import inside  # few answers need it

    seen = inside.Inside()
    seen.look()
    time.sleep(UNFINISHED_SEC)
    seen.look()
    lasting = seen.callbacks(at_least_sec=UNFINISHED_SEC)
    return next((each.line for each in lasting if node_name in each.holds and each.line), '')


def _frames(error: BaseException) -> list[traceback.FrameSummary]:
    return [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if not frame.filename.startswith(_NOT_THEIRS)
    ]


def _line(frame: traceback.FrameSummary) -> str:
    return f'{_place(frame.filename)}line {frame.lineno}, in {frame.name}: {frame.line}'


def _unpublished(error: BaseException) -> tuple[str, str] | None:
    """The field for which a message did not travel, and its type: rclpy's function has both."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        publisher, message = (frame.f_locals.get(name) for name in ('self', 'msg'))
        if isinstance(publisher, Publisher):
            type_: Any = publisher.msg_type
            if isinstance(message, type_):
                path, _, type_name = wrong_field(message, type_)
                return (path, type_name) if path else None
    return None


def _service(error: BaseException) -> str:
    """The service whose callback raised: rclpy's own function, that called it, knows it."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        service = frame.f_locals.get('srv')
        if frame.f_code.co_name == '_execute' and isinstance(service, Service):
            return service.service_name
    return ''


def _place(filename: str) -> str:
    """Name the file; cells of the notebook live in files with names that tell nothing."""
    path = Path(filename)
    if path.parent.name.startswith('ipykernel_') or filename.startswith('<'):
        return ''
    return f'{path.name}, '
