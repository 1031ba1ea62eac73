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
    notebook = shell()
    if notebook is None or 'MY_ROBOT_BASICS_ROOM' in os.environ:
        return
    if (notebook, function) not in _registered:
        notebook.events.register('post_run_cell', function)
        _registered.append((notebook, function))
