"""Note a coroutine that the answer calls without `await`: its code never runs, nothing waits.

Python only prints a warning, once, which is easily overlooked.
"""

import re
import sys
import traceback
import warnings
from collections.abc import Callable, Coroutine
from typing import Any

_HOOK = '_warn_unawaited_coroutine'
"""The function of `warnings` that Python calls for each such coroutine, unlike `showwarning`."""

_noted: list[tuple[str, int, str]] = []
"""The first one since `watch`, as `first` returns it; it is the only entry."""


def watch() -> None:
    """Forget what was noted, and note the next one."""
    _noted.clear()
    former = getattr(warnings, _HOOK, None)
    if former is not None and not isinstance(former, _Noting):
        setattr(warnings, _HOOK, _Noting(former))


def first() -> tuple[str, int, str]:
    """Return the first coroutine that was not awaited: its name, and the line that calls it.

    The line has a number and a text. The name is '' if there is no such coroutine.
    """
    return _noted[0] if _noted else ('', 0, '')


class _Noting:
    """Notes the coroutine, then warns as Python does."""

    def __init__(self, warn: Callable[[Coroutine[Any, Any, Any]], object]) -> None:
        self._warn = warn

    def __call__(self, coroutine: Coroutine[Any, Any, Any]) -> None:
        if not _noted:
            name = getattr(coroutine, '__name__', '')
            frame = sys._getframe(1)  # Python calls this where the coroutine is dropped
            [dropped] = traceback.StackSummary.extract([(frame, frame.f_lineno)])
            # elsewhere, such as at the end of a node, it was not dropped by the line that made it
            if name and re.search(rf'\b{re.escape(name)}\(', dropped.line or ''):
                _noted.append((name, dropped.lineno or 0, dropped.line or ''))
        self._warn(coroutine)
