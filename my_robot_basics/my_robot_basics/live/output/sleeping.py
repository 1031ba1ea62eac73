"""Find the line at which a callback of the notebook sleeps most of the time, and for how long."""

import sys
import time
import traceback
from collections import Counter
from types import FrameType

from rclpy import executors
from rclpy.task import Task

from my_robot_basics.doctor.waits import blocked_nodes
from my_robot_basics.doctor.work import callbacks_in_progress, thread_stacks

LOOKS, PAUSE_SEC = 40, 0.0125
"""How often, and after which pause, to look where the threads are."""
MOST_PART = 0.6
"""A callback that sleeps for this part of the time delays the next call of its timer."""
LONGEST_LOOK_SEC = 0.05
"""How much of the time between two looks counts at most: on a busy machine, a callback may be
late by as much as the thread that looks."""
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


def sleeps_on(node_name: str, seconds: float) -> tuple[int, str]:
    """Return the line at which a callback that blocks the node sleeps for `seconds`; or 0, ''.

    Meanwhile this thread runs again and again, so one whose sleep is over would run, too, however
    busy the machine is. It returns as soon as no callback is asleep.
    """
    task, line, slept_sec, last = None, _NONE, 0.0, time.monotonic()
    while slept_sec < seconds:
        time.sleep(PAUSE_SEC)
        now, asleep = time.monotonic(), _tasks_asleep()
        if task is None:
            task = next((each for each in asleep if _blocks(each, node_name)), None)
        elif task in asleep:
            slept_sec += min(now - last, LONGEST_LOOK_SEC)
        if task is None or task not in asleep:
            return _NONE
        line, last = asleep[task], now
    return line


def _blocks(task: Task, node_name: str) -> bool:
    works = (work for work in callbacks_in_progress(thread_stacks()) if work.task is task)
    blocked = (node.get_fully_qualified_name() for work in works for node in blocked_nodes(work))
    return node_name in blocked


def _tasks_asleep() -> dict[Task, tuple[int, str]]:
    """Return the callbacks that sleep at the moment, and at which lines."""
    return {
        task: line
        for frame in sys._current_frames().values()
        if (line := _sleeps_in_callback(frame)) != _NONE and (task := _task_of(frame)) is not None
    }


def _task_of(frame: FrameType | None) -> Task | None:
    while frame is not None and frame.f_code is not Task.__call__.__code__:
        frame = frame.f_back
    return None if frame is None else frame.f_locals['self']


def _sleeps_in_callback(frame: FrameType) -> tuple[int, str]:
    """Return the line of a thread's newest frame if it sleeps there, called by an executor."""
    [newest] = traceback.StackSummary.extract([(frame, frame.f_lineno)])
    if 'sleep(' not in (newest.line or '') or newest.filename == executors.__file__:
        return _NONE
    outer = frame.f_back
    while outer is not None and outer.f_code.co_filename != executors.__file__:
        outer = outer.f_back
    return _NONE if outer is None else (newest.lineno or 0, newest.line or '')
