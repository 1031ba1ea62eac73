"""Errors of rclpy's that do no harm, and that nobody can catch: they are not shown."""

import sys
import threading
from collections.abc import Callable

from rclpy.executors import Executor, ExternalShutdownException
from rclpy.signals import SignalHandlerGuardCondition

from my_robot_basics.exchange.wire import THREADS
from my_robot_basics.live import troubles

_OF_EXECUTORS = {each.__del__.__qualname__ for each in (Executor, SignalHandlerGuardCondition)}


def hide() -> None:
    """Show no such error from now on, in a thread or while an object is deleted."""
    threading.excepthook = _without_shutdowns(threading.excepthook)
    sys.unraisablehook = _without_races(sys.unraisablehook)


def _without_shutdowns(
    former: Callable[[threading.ExceptHookArgs], object],
) -> Callable[[threading.ExceptHookArgs], None]:
    """Make a hook for threads that a student lets spin: that rclpy is shut down is no error.

    Any other one is remembered: a check that misses a message can tell why it does not come.
    """

    def hook(args: threading.ExceptHookArgs) -> None:
        if args.exc_type and issubclass(args.exc_type, ExternalShutdownException):
            return
        if args.exc_value is not None:
            troubles.remember(THREADS, args.exc_value)
        former(args)

    return hook


def _without_races(
    former: Callable[['sys.UnraisableHookArgs'], object],
) -> Callable[['sys.UnraisableHookArgs'], None]:
    """Make a hook for what rclpy raises while something of its own is deleted.

    A Context removes executors that are gone from a list without a lock; where two go at the same
    moment, it may miss one. An executor misses its parts where an interrupt came as it was made.
    Shown in a cell that is being validated, that would cost its points.
    """

    def hook(args: 'sys.UnraisableHookArgs') -> None:
        where = getattr(args.object, '__qualname__', '')
        missed = args.exc_type is ValueError and where.startswith('WeakMethod.')
        half_made = args.exc_type is AttributeError and where in _OF_EXECUTORS
        if not (missed or half_made):
            former(args)

    return hook
