"""What a student needs to know of an exception: the error, and which of their lines led to it."""

import traceback
from pathlib import Path

import rclpy

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


def _place(filename: str) -> str:
    """Name the file; cells of the notebook live in files with names that tell nothing."""
    path = Path(filename)
    if path.parent.name.startswith('ipykernel_') or filename.startswith('<'):
        return ''
    return f'{path.name}, '
