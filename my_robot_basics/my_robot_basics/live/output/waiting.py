"""Wait for a condition that other threads or processes fulfil, with a timeout."""

import time
from collections.abc import Callable

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.output import notebook
from my_robot_basics.session.errors import NotRunnable, WaitTimeout

PAUSE_SEC = 0.01
"""The pause between two tests of the condition."""

SILENT_SEC = 1.0
"""If a wait takes longer, the elapsed time is shown and updated at this interval."""


def wait_until(condition: Callable[[], object], timeout_sec: float = 5.0) -> None:
    """Return as soon as condition() is true.

    A wait of more than a second shows the elapsed time, which disappears at the end. Raises
    WaitTimeout, a TimeoutError, if the condition is still false after `timeout_sec`, and
    NotRunnable for a condition that is not a function.
    """
    __tracebackhide__ = True
    if not callable(condition):
        raise NotRunnable(
            f'wait_until expects a function, saw {condition!r:.40}: write wait_until(lambda: …)'
        )
    start = time.monotonic()
    progress = _Progress(timeout_sec)
    try:
        while not condition():
            waited_sec = time.monotonic() - start
            if waited_sec >= timeout_sec:
                raise WaitTimeout(
                    f'waited {timeout_sec:g} s, and it did not happen: is the node still running, '
                    'and did you run the cells above?'
                )
            progress.show(waited_sec)
            time.sleep(PAUSE_SEC)
    finally:
        progress.clear()


class _Progress:
    """A line in the waiting cell with the elapsed time."""

    def __init__(self, timeout_sec: float) -> None:
        self._timeout_sec = timeout_sec
        self._display: notebook.Display | None = None
        self._next_sec = SILENT_SEC

    def show(self, waited_sec: float) -> None:
        if waited_sec < self._next_sec:
            return
        self._next_sec += SILENT_SEC
        line = in_language_here(f'waiting … {waited_sec:.0f} s of at most {self._timeout_sec:g} s')
        if self._display is None:
            self._display = notebook.Display()
            self._display.show({})  # empty: tools that compare two runs see only this first state
        self._display.update({'text/plain': line})

    def clear(self) -> None:
        if self._display is not None:
            self._display.update({})
