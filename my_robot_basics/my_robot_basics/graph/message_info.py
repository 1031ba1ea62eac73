"""Callbacks that get what DDS knows of a message beside the message."""

from collections.abc import Callable
from typing import Any


def with_info(callback: Callable[[Any, dict[str, Any]], None]) -> Callable[..., None]:
    """Return the callback as `create_subscription` takes it.

    rclpy looks at its parameters: to two of them it gives the message and a dict, with
    'source_timestamp' in nanoseconds among others. Its own type knows callbacks of one alone.
    """
    return callback
