"""Find the line at which a callback of the notebook sleeps most of the time."""

import sys
import time
import traceback
from collections import Counter
from types import FrameType

from rclpy import executors

LOOKS, PAUSE_SEC = 40, 0.0125
"""How often, and after which pause, to look where the threads are."""
MOST_PART = 0.6
"""A callback that sleeps for this part of the time delays the next call of its timer."""
_NONE = 0, ''


def sleeping_line() -> tuple[int, str]:
    """Return the line at which callbacks sleep for most of half a second; 0 and '' if none does.

    The line has a number and a text.
    """
    seen: Counter[tuple[int, str]] = Counter()
    for _ in range(LOOKS):
        time.sleep(PAUSE_SEC)
        seen.update(map(_sleeps_in_callback, sys._current_frames().values()))
    seen.pop(_NONE, None)
    return next((line for line, times in seen.most_common(1) if times >= MOST_PART * LOOKS), _NONE)


def _sleeps_in_callback(frame: FrameType) -> tuple[int, str]:
    """Return the line of a thread's newest frame if it sleeps there, called by an executor."""
    [newest] = traceback.StackSummary.extract([(frame, frame.f_lineno)])
    if 'sleep(' not in (newest.line or '') or newest.filename == executors.__file__:
        return _NONE
    outer = frame.f_back
    while outer is not None and outer.f_code.co_filename != executors.__file__:
        outer = outer.f_back
    return _NONE if outer is None else (newest.lineno or 0, newest.line or '')
