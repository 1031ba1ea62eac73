"""Let rclpy's EventsExecutor wait without a timeout, as `spin()` asks it to.

In the wheel, the deadline of a wait without a timeout overflows: the wait polls the clock
without a pause, handles no event, and blocks all threads that have one. With a timeout, it
works. `./course` links this into .venv as a module of its own, which rclpy's
`experimental/events_executor.py` imports at its end.
"""

from collections.abc import Callable
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.task import Future

LONG_SEC = 1e8
"""About three years: longer than a node runs."""


def add_timeouts(executor_class: Any) -> None:
    """Give LONG_SEC as the timeout to each wait of the class that has none."""
    once = executor_class.spin_once

    def spin_once(self: Any, timeout_sec: float | None = None) -> None:
        once(self, LONG_SEC if timeout_sec is None else timeout_sec)

    def spin(self: Any) -> None:
        self.spin_until_future_complete(Future())

    executor_class.spin_once, executor_class.spin = spin_once, spin
    for name in ('spin_until_future_complete', 'spin_once_until_future_complete'):
        setattr(executor_class, name, _with_timeout(getattr(executor_class, name)))


def _with_timeout(wait: Callable[..., None]) -> Callable[..., None]:
    def wait_for(self: Any, future: Future, timeout_sec: float | None = None) -> None:
        wait(self, future, LONG_SEC if timeout_sec is None else timeout_sec)

    return wait_for


add_timeouts(rclpy_implementation.EventsExecutor)
