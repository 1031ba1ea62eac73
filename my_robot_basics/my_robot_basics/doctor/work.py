"""The callbacks that are in progress in this process, with the frames that each executes.

rclpy keeps a callback as a Task in its executor's list until it has returned.
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
    """A callback that has started and has not returned."""

    task: Task
    executor: Executor
    entity: Any
    """The timer, subscription, service or client; None for a done callback of a future."""
    node: Node | None
    frames: list[FrameType] = field(repr=False)
    """From the outermost; empty while a coroutine resumes."""
    is_running: bool
    """Whether it occupies a thread; else it is a suspended coroutine."""


def own_nodes() -> Iterator[Node]:
    """Yield the nodes of this process, except the course's hidden ones."""
    return filter(_is_student_node, nodes_here())


def thread_stacks() -> list[list[FrameType]]:
    """Return the frames of each thread, from the outermost."""
    found = []
    frame: FrameType | None
    for frame in sys._current_frames().values():
        frames = []
        while frame is not None:
            frames.append(frame)
            frame = frame.f_back
        found.append(frames[::-1])
    return found


def spinning_executors(threads: list[list[FrameType]]) -> set[Executor]:
    """Return the executors of which a thread executes a method."""
    callers = (frame.f_locals.get('self') for frames in threads for frame in frames)
    return {caller for caller in callers if isinstance(caller, Executor)}


def callbacks_in_progress(threads: list[list[FrameType]]) -> Iterator[Work]:
    """Yield the callbacks of this process that have started and have not returned."""
    running = {
        frames[i].f_locals['self']: frames[i + 1 :]
        for frames in threads
        for i in range(len(frames))
        if frames[i].f_code is _TASK
    }
    # running tasks, too: a node that was removed from its executor no longer refers to it
    executors = {task._executor() for task in running} | {n.executor for n in own_nodes()}
    for executor in filter(None, executors):
        for task, entity, node in [*getattr(executor, '_tasks', [])]:
            if task.done() or (node is not None and not _is_student_node(node)):
                continue
            frames = running.get(task) or [*_suspended(task._handler)]
            if frames or task.executing():
                is_running = task in running
                yield Work(task, executor, entity, node, frames, is_running)


def _is_student_node(node: Node) -> bool:
    """Whether a node is neither a hidden one of the course nor destroyed."""
    try:
        return not node.get_name().startswith(HIDDEN)
    except InvalidHandle:  # destroyed, although a callback of it has not returned
        return False


def _suspended(awaiting: Any) -> Iterator[FrameType]:
    """Yield the frames of a coroutine that has started and is suspended, from the outermost."""
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
