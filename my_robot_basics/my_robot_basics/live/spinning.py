"""What a ROS 2 program does for itself and a cell should not: `rclpy.init` again, `rclpy.spin`.

In a program of its own, Ctrl-C ends `rclpy.spin`. In a notebook's kernel nothing would: rclpy
waits where Python's signals do not reach it, and the kernel could only be restarted.
"""

import contextlib
import functools
import threading
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor, TimeoutException, TimeoutObject
from rclpy.node import Node

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.destroying import destroy
from my_robot_basics.live.patching import patch
from my_robot_basics.session.errors import LiveError, in_lines, tell

POLL_SEC = 0.1
"""How long a cell may take to notice that it is interrupted."""


class AlreadyInitialised(LiveError, RuntimeError):
    """`rclpy.init` was called while rclpy is up; rclpy itself raises a RuntimeError, too."""


class AlreadySpinning(LiveError):
    """`rclpy.spin` was given a node that spins in the background."""


class SpinInterrupted(KeyboardInterrupt):
    """`rclpy.spin` was interrupted; IPython shows the message alone."""

    def _render_traceback_(self) -> list[str]:
        return in_lines(in_language_here(str(self)))


def help_in_cells() -> None:
    """Let cells that block be interrupted, and explain what goes wrong in them.

    Only the thread in which cells run sees a difference: a student's own threads spin as ever.
    """
    wait = _interruptible(Executor.wait_for_ready_callbacks)
    patch(Executor, 'wait_for_ready_callbacks', wait)
    rclpy.init = _explaining_init(rclpy.init)
    rclpy.spin = _explaining_spin(rclpy.spin)


def _in_a_cell() -> bool:
    return threading.current_thread() is threading.main_thread()


def _interruptible(wait: Callable[..., Any]) -> Callable[..., Any]:
    """Make an endless wait one of many short ones: Python sees the interrupt between them."""

    @functools.wraps(wait)
    def wait_in_steps(
        self: Executor,
        timeout_sec: float | TimeoutObject | None = None,
        *args: Any,
        **kwargs: Any,
    ) -> Any:
        limit = timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
        if not _in_a_cell() or (limit is not None and limit >= 0):
            return wait(self, timeout_sec, *args, **kwargs)
        while True:
            with contextlib.suppress(TimeoutException):
                return wait(self, POLL_SEC, *args, **kwargs)

    return wait_in_steps


def _explaining_init(init: Callable[..., None]) -> Callable[..., None]:
    @functools.wraps(init)
    def explaining_init(*args: Any, context: Context | None = None, **kwargs: Any) -> None:
        __tracebackhide__ = True
        if context is None and rclpy.ok():
            raise AlreadyInitialised(
                'rclpy is initialised already, by the first run(...) or by your own cell: leave '
                'rclpy.init() out here, and run this cell again'
            )
        init(*args, context=context, **kwargs)

    return explaining_init


def _explaining_spin(spin: Callable[..., None]) -> Callable[..., None]:
    @functools.wraps(spin)
    def explaining_spin(node: Node, executor: Executor | None = None) -> None:
        __tracebackhide__ = True
        if not _in_a_cell():
            spin(node, executor)
            return
        name, made = node.get_name(), f'run({type(node).__name__})'
        if node.executor is not None:
            raise AlreadySpinning(
                f'{name} spins in the background already: leave rclpy.spin out, and go on with '
                'the next cell'
            )
        try:  # an interrupt may come as soon as the line is read
            tell(
                f'rclpy.spin keeps this cell busy while {name} runs, and no other cell can run: '
                'press ■ (Interrupt the kernel) above to stop it.'
            )
            spin(node, executor)
        except KeyboardInterrupt:
            destroy(node)
            raise SpinInterrupted(
                f'rclpy.spin was interrupted, and {name} is stopped. To go on, write {made} '
                f'in place of the lines that make {name} and spin it, and run this cell again: '
                'run spins in the background.'
            ) from None

    return explaining_spin
