"""Subscription callbacks that get DDS's message info beside the message."""

from collections.abc import Callable
from typing import Any


def with_info(callback: Callable[[Any, dict[str, Any]], None]) -> Callable[..., None]:
    """Return the callback with a type that `create_subscription` accepts.

    rclpy passes the message and a dict to a callback with two parameters; the dict contains
    'source_timestamp' in nanoseconds. But rclpy's type hints allow one parameter only.
    """
    return callback
