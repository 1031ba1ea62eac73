"""Print the traceback of an action's execute callback once for each place that raises.

rclpy catches what the callback raises, logs it, and prints its traceback. A check sends many
goals: one wrong line put over a hundred red ones between the answer and the check's own message.
"""

import sys
import traceback
from types import SimpleNamespace

from rclpy.action import server


def print_once() -> None:
    """From now on, let each action server print a traceback only if it ends at a new place."""
    vars(server)['traceback'] = SimpleNamespace(print_exc=_print_if_new)


def _print_if_new() -> None:
    """Called by ActionServer._execute_goal in place of traceback.print_exc."""
    error = sys.exception()
    assert error is not None
    assert error.__traceback__ is not None
    action_server = error.__traceback__.tb_frame.f_locals['self']
    printed = action_server.__dict__.setdefault('_printed_tracebacks', set())
    frames = traceback.extract_tb(error.__traceback__)
    place = type(error), *((frame.filename, frame.lineno) for frame in frames)
    if place not in printed:
        printed.add(place)
        traceback.print_exc()
