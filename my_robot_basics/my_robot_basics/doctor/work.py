"""The callbacks that are in progress in this process at one moment, and where each of them is.

A callback is a Task in its executor's list, from when it begins until it has returned.
"""

import inspect
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.task import Task

from my_robot_basics.graph.watcher import HIDDEN
from my_robot_basics.session.neighbours import nodes_here

_TASK = Task.__call__.__code__


@dataclass(frozen=True)
class Work:
    """A callback that has begun and has not returned."""

    task: Task
    executor: Executor
    entity: Any
    """The timer, subscription, service or client; None: it is called when a future is done."""
    node: Node | None
    frames: list[FrameType] = field(repr=False)
    """From the outermost; empty in the moment in which a coroutine goes on."""
    is_running: bool
    """Whether it occupies a thread; else it is a coroutine that waits."""


def own_nodes() -> Iterator[Node]:
    """The nodes of this process, without the course's own."""
    return filter(_is_theirs, nodes_here())


def stacks() -> list[list[FrameType]]:
    """The frames of each thread, from the outermost."""
    found = []
    frame: FrameType | None
    for frame in sys._current_frames().values():
        frames = []
        while frame is not None:
            frames.append(frame)
            frame = frame.f_back
        found.append(frames[::-1])
    return found


def spinning(threads: list[list[FrameType]]) -> set[Executor]:
    """The executors in whose methods a thread is."""
    callers = (frame.f_locals.get('self') for frames in threads for frame in frames)
    return {caller for caller in callers if isinstance(caller, Executor)}


def in_progress(threads: list[list[FrameType]]) -> Iterator[Work]:
    """The callbacks of this process that have begun and have not returned."""
    running = {
        frames[i].f_locals['self']: frames[i + 1 :]
        for frames in threads
        for i in range(len(frames))
        if frames[i].f_code is _TASK
    }
    # a node that was taken from its executor leads no more to the one in which it still runs
    executors = {task._executor() for task in running} | {n.executor for n in own_nodes()}
    for executor in filter(None, executors):
        for task, entity, node in [*getattr(executor, '_tasks', [])]:
            if task.done() or (node is not None and not _is_theirs(node)):
                continue
            frames = running.get(task) or [*_suspended(task._handler)]
            if frames or task.executing():
                is_running = task in running
                yield Work(task, executor, entity, node, frames, is_running)


def _is_theirs(node: Node) -> bool:
    """Whether a node is neither the course's own nor destroyed."""
    try:
        return not node.get_name().startswith(HIDDEN)
    except InvalidHandle:  # and a callback of it has not returned
        return False


def _suspended(awaiting: Any) -> Iterator[FrameType]:
    """The frames of a coroutine that has begun and waits, from the outermost."""
    if not inspect.iscoroutine(awaiting):
        return
    if inspect.getcoroutinestate(awaiting) != inspect.CORO_SUSPENDED:
        return
    while awaiting is not None:
        frame = getattr(awaiting, 'cr_frame', None) or getattr(awaiting, 'gi_frame', None)
        if frame is None:
            return
        yield frame
        awaiting = getattr(awaiting, 'cr_await', None) or getattr(awaiting, 'gi_yieldfrom', None)
