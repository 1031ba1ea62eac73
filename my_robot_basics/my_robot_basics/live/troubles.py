"""What a student needs to know of an exception: the error, and which of their lines led to it."""

import traceback
from pathlib import Path

import rclpy
from rclpy.service import Service

_last: dict[str, str] = {}
"""What a callback of a node raised last, by the node's full name."""
_times: dict[str, int] = {}
"""How often one has raised."""
_of_services: dict[tuple[str, str], str] = {}
"""What the callback of a service raised last, by the node's and the service's full names."""
_NOT_THEIRS = (str(Path(rclpy.__file__).parent), str(Path(__file__).parent))


def where_and_what(error: BaseException) -> tuple[str, str]:
    """Return where the error happened, outermost call first, and what it says."""
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if not frame.filename.startswith(_NOT_THEIRS)
    ]
    where = '\n'.join(
        f'  {_place(frame.filename)}line {frame.lineno}, in {frame.name}: {frame.line}'
        for frame in frames
    )
    return where, ''.join(traceback.format_exception_only(error)).strip()


def remember(node_name: str, error: BaseException) -> None:
    """Note what a callback of the node raised, and where."""
    where, what = where_and_what(error)
    place = where.rpartition('\n')[2].strip()
    _last[node_name] = f'{what} ({place})' if place else what
    _times[node_name] = times(node_name) + 1
    if service_name := _service(error):
        _of_services[node_name, service_name] = _last[node_name]


def forget(node_name: str) -> None:
    """Forget it: a new node of that name begins."""
    _last.pop(node_name, None)
    _times.pop(node_name, None)
    for key in [key for key in _of_services if key[0] == node_name]:
        del _of_services[key]


def forget_all() -> None:
    """Forget what the nodes of all names raised: an exercise begins."""
    _last.clear()
    _times.clear()
    _of_services.clear()


def last(node_name: str) -> str:
    """Return what a callback of the node raised last, or ''."""
    return _last.get(node_name, '')


def times(node_name: str) -> int:
    """Return how often a callback of the node has raised."""
    return _times.get(node_name, 0)


def of_service(service_name: str) -> dict[str, str]:
    """Return what the callbacks of a service raised last, by their nodes' full names."""
    return {node: what for (node, name), what in _of_services.items() if name == service_name}


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
