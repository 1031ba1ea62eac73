"""Make all waits of a cell interruptible, by JupyterLab's ■ or at the cell's time limit.

Python raises KeyboardInterrupt only between two of its own instructions. In a normal program,
rclpy's handler of SIGINT ends a wait in C++; in a kernel, ipykernel replaces that handler for each
cell, and such a wait would not end.
"""

import contextlib
import functools
import os
import signal
import sys
import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import rclpy
from rclpy import wait_for_message
from rclpy.executors import Executor, TimeoutException, TimeoutObject
from rclpy.impl.implementation_singleton import rclpy_implementation

from my_robot_basics.live.patches.patching import patch

POLL_SEC = 0.1
"""How long a cell may take to notice that it is interrupted."""


def let_cells_be_interrupted() -> None:
    """Make waits in rclpy without a timeout interruptible.

    This changes only the thread in which cells run: a student's own threads spin as before.
    """
    from ipykernel import iostream  # a kernel has loaded it; others need not

    wait = _interruptible(Executor.wait_for_ready_callbacks)
    patch(Executor, 'wait_for_ready_callbacks', wait)
    wait_for_message._rclpy = SimpleNamespace(WaitSet=_InterruptibleWaitSet)
    vars(iostream)['threading'] = SimpleNamespace(**vars(threading) | {'Event': _Flushed})
    sys.unraisablehook = _sending_again(sys.unraisablehook)
    if sys.version_info < (3, 13):
        patch(threading.Thread, '_wait_for_tstate_lock', _wait_for_end)


def forget_dead_executor() -> None:
    """Make `rclpy.spin` create a new global executor if the current one's context is shut down.

    An interrupt while it was created, or one that rclpy's own handler handled, can leave such an
    executor: each `spin` would return at once.
    """
    kept = vars(rclpy).get('__executor')
    if kept is not None and not kept.context.ok():
        vars(rclpy)['__executor'] = None


def in_a_cell() -> bool:
    """Whether this thread is the one in which cells run."""
    return threading.current_thread() is threading.main_thread()


def _interruptible(wait: Callable[..., Any]) -> Callable[..., Any]:
    """Split a wait without a timeout into short ones: Python handles an interrupt between them."""

    @functools.wraps(wait)
    def wait_in_steps(
        self: Executor,
        timeout_sec: float | TimeoutObject | None = None,
        *args: Any,
        **kwargs: Any,
    ) -> Any:
        limit = timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
        if not in_a_cell() or (limit is not None and limit >= 0):
            return wait(self, timeout_sec, *args, **kwargs)
        while True:
            with contextlib.suppress(TimeoutException):
                return wait(self, POLL_SEC, *args, **kwargs)

    return wait_in_steps


class _InterruptibleWaitSet(rclpy_implementation.WaitSet):
    """The same for `wait_for_message`, which waits for one subscription without an executor."""

    def __init__(self, *numbers_and_context: Any) -> None:
        super().__init__(*numbers_and_context)
        self._added: list[tuple[Callable[[Any], object], Any]] = []

    def add_subscription(self, handle: Any) -> None:
        self._add(super().add_subscription, handle)

    def add_guard_condition(self, handle: Any) -> None:
        self._add(super().add_guard_condition, handle)

    def _add(self, add: Callable[[Any], object], handle: Any) -> None:
        add(handle)
        self._added.append((add, handle))

    def wait(self, timeout_nsec: int) -> None:
        if not in_a_cell() or timeout_nsec >= 0:
            super().wait(timeout_nsec)
            return
        super().wait(int(POLL_SEC * 1e9))
        while not any(map(self.get_ready_entities, ('subscription', 'guard_condition'))):
            self.clear_entities()  # a wait removes the entities that were not ready
            for add, handle in self._added:
                add(handle)
            super().wait(int(POLL_SEC * 1e9))


class _Flushed:
    """An event that is set once, without a lock that an interrupt could leave locked.

    When a cell flushes its output, it waits until ipykernel's output thread sets such an event.
    With `threading.Event`, an interrupt at the wrong moment leaves the event's lock locked: the
    thread would wait for it forever, and no cell would seem to end any more.
    """

    def __init__(self) -> None:
        self._unset = threading.Lock()
        self._unset.acquire()

    def set(self) -> None:
        self._unset.release()

    def wait(self, timeout: float) -> bool:
        return self._unset.acquire(timeout=timeout)


def _sending_again(
    former: Callable[['sys.UnraisableHookArgs'], object],
) -> Callable[['sys.UnraisableHookArgs'], None]:
    """Make a hook that sends SIGINT again if it came in a `__del__`, where Python drops it."""

    def hook(args: 'sys.UnraisableHookArgs') -> None:
        if not (issubclass(args.exc_type, KeyboardInterrupt) and in_a_cell()):
            former(args)
            return
        # not at once: it would come in this hook, and be dropped again
        again = threading.Timer(POLL_SEC, os.kill, (os.getpid(), signal.SIGINT))
        again.daemon = True
        again.start()

    return hook


def _wait_for_end(thread: Any, block: bool = True, timeout: float = -1) -> None:
    """Wait for a thread's end as `Thread.is_alive` and `join` do, but safely for interrupts.

    Before 3.13, an interrupt in this function can make Python take a running thread for an ended
    one. ipykernel calls `is_alive` of its output thread at each print: once that is False, all
    threads use its socket at the same time and messages are lost, even a cell's final one.
    """
    lock = thread._tstate_lock
    if lock is None:
        return
    try:
        if lock.acquire(block, timeout):
            lock.release()
            thread._stop()
    except BaseException:
        if lock.locked() and thread.ident not in sys._current_frames():
            lock.release()  # this function has acquired it: the thread has ended
            thread._stop()
        raise
