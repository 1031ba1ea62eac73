"""Which cells of a student's own notebook have run in this kernel, and how their last run ended.

Imports nothing that is slow.
"""

import json
import os
from pathlib import Path
from typing import Any

from my_robot_basics.session import kernel

_texts: dict[str, str] = {}
"""The text of each cell that was run, by cell id; the one that runs now is the last."""
_errors: dict[str, str] = {}
"""What ended a cell's last run too early, such as 'NameError: …', by cell id. The exception itself
would keep nodes of the student's alive."""


def watch() -> None:
    """From now on, note the cells that are run; a second call does nothing."""
    kernel.call_before_cells(_note_start)
    kernel.call_after_cells(_note_end)


def current() -> str:
    """Return the id of the cell that runs now, or ran last; '' if there is none."""
    return next(reversed(_texts), '')


def text_of(cell_id: str) -> str:
    """Return the text with which a cell ran last, '' if it has not run in this kernel."""
    return _texts.get(cell_id, '')


def error_of(cell_id: str) -> str:
    """Return the type and message of the exception that ended a cell's last run, or ''."""
    return _errors.get(cell_id, '') if cell_id else ''


def lesson() -> dict[str, Any]:
    """Return this kernel's notebook as it was saved last; {} if it is unknown."""
    path = Path(os.environ.get('JPY_SESSION_NAME', ''))
    try:
        read = json.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return {}
    return read if isinstance(read, dict) else {}


def _note_start(info: Any) -> None:
    cell_id = getattr(info, 'cell_id', None) or ''
    _texts.pop(cell_id, None)
    _texts[cell_id] = info.raw_cell or ''


def _note_end(result: Any) -> None:
    cell_id = getattr(result.info, 'cell_id', None) or ''
    error = result.error_before_exec or result.error_in_exec
    _errors.pop(cell_id, None)
    if error is not None:
        # without the file and line that Python appends to a SyntaxError's message
        what = error.msg if isinstance(error, SyntaxError) else error
        _errors[cell_id] = f'{type(error).__name__}: {what}'.rstrip(': ')
