"""Let an ActionClient note each request before another thread handles its response.

In Jazzy's rclpy, a goal is sent first, and its number noted afterwards. If another thread of the
executor takes the response in between, it knows no such number: it logs "Ignoring unexpected goal
response", and the future is never done. So are results and requests to cancel. On a busy machine,
right answers lost points in this way. See https://github.com/ros2/rclpy/issues/1123, which is
fixed in later releases.
"""

import functools
import threading
from collections.abc import Callable
from typing import Any

from rclpy.action import ActionClient

from my_robot_basics.live.patches.patching import patch

_REQUESTS = 'send_goal_async', '_cancel_goal_async', '_get_result_async'
_NOTED_SEC = 1.0
"""How long to wait at most until a request that was sent is noted."""


def note_requests_first() -> None:
    """Make each ActionClient take responses only when all requests under way are noted."""
    for name in _REQUESTS:
        patch(ActionClient, name, _under_lock(getattr(ActionClient, name)))
    patch(ActionClient, 'take_data', _after_requests(ActionClient.take_data))


def _lock_of(client: ActionClient) -> threading.Lock:
    return client.__dict__.setdefault('_requests_lock', threading.Lock())


def _under_lock(request: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(request)
    def request_under_lock(self: ActionClient, *args: Any, **kwargs: Any) -> Any:
        __tracebackhide__ = True
        with _lock_of(self):
            return request(self, *args, **kwargs)

    return request_under_lock


def _after_requests(take_data: Callable[[ActionClient], dict]) -> Callable[[ActionClient], dict]:
    @functools.wraps(take_data)
    def take_after_requests(self: ActionClient) -> dict:
        taken = take_data(self)
        lock = _lock_of(self)
        if lock.acquire(timeout=_NOTED_SEC):  # what was taken answers a request sent before
            lock.release()
        return taken

    return take_after_requests
