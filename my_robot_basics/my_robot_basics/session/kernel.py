"""Whether this process is a notebook's kernel. Imports nothing that is slow."""

import os
import sys
from collections.abc import Callable
from typing import Any

_registered: list[tuple[Any, Callable[[Any], None]]] = []


def shell() -> Any:
    """Return IPython's shell if it runs in a kernel, else None."""
    if 'IPython' not in sys.modules:
        return None
    found = sys.modules['IPython'].get_ipython()
    return found if hasattr(found, 'kernel') else None


def call_after_cells(function: Callable[[Any], None]) -> None:
    """From now on, call it with the result of each cell of a student's own notebook.

    A second call does nothing, nor does one at grading or outside of a notebook.
    """
    _call('post_run_cell', function)


def call_before_cells(function: Callable[[Any], None]) -> None:
    """The same, before each cell, with what is known about it: its text, and its id."""
    _call('pre_run_cell', function)


def _call(event: str, function: Callable[[Any], None]) -> None:
    notebook = shell()
    if notebook is None or 'MY_ROBOT_BASICS_ROOM' in os.environ:
        return
    if (notebook, function) not in _registered:
        notebook.events.register(event, function)
        _registered.append((notebook, function))
