"""Hide harmless errors and warnings of rclpy that no code can catch."""

import re
import sys
import threading
import warnings
from collections.abc import Callable

from rclpy.executors import Executor, ExternalShutdownException
from rclpy.signals import SignalHandlerGuardCondition

from my_robot_basics.exchange.wire import THREADS
from my_robot_basics.live.output import troubles

_GONE = re.compile(r'failed to send response \(timeout\)')
_OF_EXECUTORS = {each.__del__.__qualname__ for each in (Executor, SignalHandlerGuardCondition)}


def hide() -> None:
    """Hide such errors from now on, in a thread and while an object is deleted."""
    # the client has gone, such as that of a check that failed: the student can do nothing about it
    warnings.filterwarnings('ignore', _GONE.pattern, RuntimeWarning)
    threading.excepthook = _without_shutdowns(threading.excepthook)
    sys.unraisablehook = _without_races(sys.unraisablehook)


def _without_shutdowns(
    former: Callable[[threading.ExceptHookArgs], object],
) -> Callable[[threading.ExceptHookArgs], None]:
    """Make a hook for a student's threads that spin, which ignores ExternalShutdownException.

    Other exceptions are recorded: a check that misses a message can name the reason.
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
    """Make a hook for exceptions of rclpy while one of its objects is deleted.

    A Context removes deleted executors from a list without a lock: if two are deleted at the same
    time, one may be missing. An executor lacks attributes if an interrupt came while it was
    created. If nbgrader's Validate showed such an error in a cell, it would cost the points.
    """

    def hook(args: 'sys.UnraisableHookArgs') -> None:
        where = getattr(args.object, '__qualname__', '')
        missed = args.exc_type is ValueError and where.startswith('WeakMethod.')
        half_made = args.exc_type is AttributeError and where in _OF_EXECUTORS
        if not (missed or half_made):
            former(args)

    return hook
