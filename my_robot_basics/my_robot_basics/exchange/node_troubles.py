"""Errors in a node of the notebook, as the notebook's process reports them.

They tell students where to look; the verdict depends only on what the check observes over DDS. A
check waits no longer for a callback that `sleeps_on`: that can only cost points.
"""

from typing import Any

from my_robot_basics.exchange import wire
from my_robot_basics.exchange.asking import reply_value
from my_robot_basics.feedback.errors import shorten, shorten_exception
from my_robot_basics.feedback.rclpy_names import OWN_ATTRIBUTES

_NONE = '', '', ''
_WAITS = 'wait', 'sleep', 'spin'
"""A callback at a line with one of these words waits by itself."""


def last_raised(node_name: str) -> str:
    """Return the last exception of that node's callbacks, '' if the notebook reports none."""
    body = reply_value(wire.request(op='trouble', name=node_name))
    return shorten_exception(body) if isinstance(body, str) else ''


def unpublished_field(node_name: str) -> tuple[str, str]:
    """Return the field that kept that node from publishing a message, and its type; else '', ''.

    If the field is '', the other text says how to make the object that `publish` expects.
    """
    body = reply_value(wire.request(op='field', name=node_name))
    is_told = isinstance(body, tuple) and [type(text) for text in body] == [str, str]
    return (shorten(body[0], 60), shorten(body[1], 60)) if is_told else ('', '')


def has_raised_since(node_name: str, since_ns: int) -> bool:
    """Whether that node's callbacks raised after a time, as the notebook reports.

    `since_ns` is `time.monotonic_ns()`: all processes of a machine have the same.
    """
    body = reply_value(wire.request(op='raised', name=node_name))
    return type(body) is int and body > since_ns


def blocking_line(node_name: str) -> str:
    """Return the line at which a callback of that node blocks all others, or ''."""
    body = reply_value(wire.request(op='unfinished', name=node_name))
    return shorten(body) if isinstance(body, str) else ''


def waits_in_callback(node_name: str) -> bool:
    """Whether a callback blocks that node and waits by itself, and not for a processor."""
    line = blocking_line(node_name)
    return any(word in line for word in _WAITS)


def sleeps_on(node_name: str, seconds: float) -> tuple[int, str]:
    """Return the line at which a callback that blocks that node sleeps for `seconds`; or 0, ''."""
    return _line(reply_value(wire.request(op='sleeps_on', name=node_name, args=(seconds,))))


def overwritten_attribute(node_name: str) -> str:
    """Return an attribute of rclpy's Node in which that node has a value of its own, or ''."""
    body = reply_value(wire.request(op='overwritten', name=node_name))
    return str(body) if body in OWN_ATTRIBUTES else ''


def logger_level(node_name: str) -> int:
    """Return the least severity that the node's logger logs, 0 if the notebook reports none."""
    body = reply_value(wire.request(op='level', name=node_name))
    return body if type(body) is int else 0


def sleeping_line() -> tuple[int, str]:
    """Return the line at which a callback sleeps most of the time, number and text; or 0, ''."""
    return _line(reply_value(wire.request(op='sleeping', name=wire.THREADS)))


def not_awaited() -> tuple[str, int, str]:
    """Return the coroutine that the answer has called without `await`, and the line of the call.

    The name is '' if the notebook reports none.
    """
    body = reply_value(wire.request(op='not_awaited', name=wire.THREADS))
    is_told = isinstance(body, tuple) and [type(part) for part in body] == [str, int, str]
    return (shorten(body[0], 60), body[1], shorten(body[2], 120)) if is_told else ('', 0, '')


def how_answer_ended() -> tuple[str, str, str]:
    """Return which node a later cell has ended, the node that took its place, and their name.

    The last two are '' if the cell has stopped it; all three if the notebook reports none.
    """
    body = reply_value(wire.request(op='ended', name=wire.THREADS))
    is_told = isinstance(body, tuple) and [type(text) for text in body] == [str] * 3
    return (shorten(body[0], 60), shorten(body[1], 60), shorten(body[2], 60)) if is_told else _NONE


def _line(body: Any) -> tuple[int, str]:
    is_told = isinstance(body, tuple) and [type(part) for part in body] == [int, str]
    return (body[0], shorten(body[1], 120)) if is_told else (0, '')
