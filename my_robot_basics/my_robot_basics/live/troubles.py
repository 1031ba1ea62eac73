"""What a student needs to know of an exception: the error, and which of their lines led to it."""

import traceback
from pathlib import Path

import rclpy

_last: dict[str, str] = {}
"""What a callback of a node raised last, by the node's full name."""
_times: dict[str, int] = {}
"""How often one has raised."""
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


def forget(node_name: str) -> None:
    """Forget it: a new node of that name begins."""
    _last.pop(node_name, None)
    _times.pop(node_name, None)


def forget_all() -> None:
    """Forget what the nodes of all names raised: an exercise begins."""
    _last.clear()
    _times.clear()


def last(node_name: str) -> str:
    """Return what a callback of the node raised last, or ''."""
    return _last.get(node_name, '')


def times(node_name: str) -> int:
    """Return how often a callback of the node has raised."""
    return _times.get(node_name, 0)


def _place(filename: str) -> str:
    """Name the file; cells of the notebook live in files with names that tell nothing."""
    path = Path(filename)
    if path.parent.name.startswith('ipykernel_') or filename.startswith('<'):
        return ''
    return f'{path.name}, '
