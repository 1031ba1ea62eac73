"""Explain calls that a ROS 2 program needs and a cell does not: `rclpy.init` and `rclpy.spin`.

In a program, Ctrl-C ends `rclpy.spin`; in a cell, ■ does, with the help of
`live.patches.interrupting`.
"""

import functools
import sys
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import Executor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from my_robot_basics.language.speaking import in_language_here
from my_robot_basics.live.nodes.destroying import destroy
from my_robot_basics.live.patches.interrupting import forget_dead_executor, in_a_cell
from my_robot_basics.session.errors import LiveError, in_lines, tell


class AlreadyInitialised(LiveError, RuntimeError):
    """`rclpy.init` was called again; rclpy itself raises a RuntimeError for that, too."""


class AlreadySpinning(LiveError):
    """`rclpy.spin` was called with a node that spins in the background."""


class SpinInterrupted(KeyboardInterrupt):
    """`rclpy.spin` was interrupted; IPython shows the message alone."""

    def _render_traceback_(self) -> list[str]:
        return in_lines(in_language_here(str(self)))


def help_in_cells() -> None:
    """Replace `rclpy.init` and `rclpy.spin` by versions that explain what goes wrong in cells."""
    rclpy.init = _explaining_init(rclpy.init)
    rclpy.spin = _explaining_spin(rclpy.spin)


def _explaining_init(init: Callable[..., None]) -> Callable[..., None]:
    @functools.wraps(init)
    def explaining_init(
        *args: Any,
        context: Context | None = None,
        signal_handler_options: SignalHandlerOptions | None = None,
        **kwargs: Any,
    ) -> None:
        __tracebackhide__ = True
        if context is None and rclpy.ok():
            why = (
                'rclpy is initialised already, by the first run(...) or by your own cell: leave '
                'rclpy.init() out here, and run this cell again'
            )
            raise AlreadyInitialised(in_language_here(why))  # lesson 7 prints it
        if signal_handler_options is None:
            # an interrupt ends the cell also without rclpy's signal handler, which would shut
            # down all contexts of this kernel, so that the cell's own rclpy.shutdown() fails
            signal_handler_options = SignalHandlerOptions.NO
        init(*args, context=context, signal_handler_options=signal_handler_options, **kwargs)
        forget_dead_executor()

    return explaining_init


def _explaining_spin(spin: Callable[..., None]) -> Callable[..., None]:
    @functools.wraps(spin)
    def explaining_spin(node: Node, executor: Executor | None = None) -> None:
        __tracebackhide__ = True
        if not in_a_cell():
            spin(node, executor)
            return
        name, made = node.get_name(), f'run({type(node).__name__})'
        if node.executor is not None:
            raise AlreadySpinning(
                f'{name} spins in the background already: leave rclpy.spin out, and go on with '
                'the next cell'
            )
        try:  # before the line is printed: from then on, an interrupt may come
            tell(
                f'rclpy.spin keeps this cell busy while {name} runs, and no other cell can run: '
                'press ■ (Interrupt the kernel) above to stop it.'
            )
            spin(node, executor)
        except KeyboardInterrupt:
            destroy(node)
            if _is_in_constructor(node):
                raise SpinInterrupted(
                    f'rclpy.spin was interrupted, and {name} is stopped. To go on, leave '
                    'rclpy.spin out of __init__, and run the cells again: run spins a node in '
                    'the background when its constructor has returned.'
                ) from None
            raise SpinInterrupted(
                f'rclpy.spin was interrupted, and {name} is stopped. To go on, write {made} '
                f'in place of the lines that make {name} and spin it, and run this cell again: '
                'run spins in the background.'
            ) from None

    return explaining_spin


def _is_in_constructor(node: Node) -> bool:
    """Whether the caller is called, directly or not, by the constructor of that node."""
    frame = sys._getframe()
    while caller := frame.f_back:
        values = caller.f_locals.values() if caller.f_code.co_name == '__init__' else ()
        if any(value is node for value in values):
            return True
        frame = caller
    return False
