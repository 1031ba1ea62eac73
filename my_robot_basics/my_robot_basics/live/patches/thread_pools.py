"""Let a MultiThreadedExecutor's threads start promptly, with the same number on any machine.

In Jazzy's rclpy, they may starve. After the executor has submitted a callback to its pool, and
until a thread starts it, the executor loops without waiting: its wait set returns at once, since
it leaves out the subscription but not its QoS events, and Fast DDS has one condition for both.
Each wait releases the GIL for about 10 µs. A thread that takes longer to wake up misses that time
again and again; and as it was woken before its own wait timed out, it does not make the executor's
thread release the GIL. On an idle machine up to half of the messages came seconds late.
See https://github.com/ros2/rclpy/issues/1452, which is fixed in later releases.

By default there are as many threads as processors. Each waiting callback occupies a thread, so an
answer could work on one machine and block on a smaller one. Therefore the number is fixed here.
"""

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from rclpy.executors import MultiThreadedExecutor

THREADS = 4
"""Enough for two waiting calls, one whose response never comes, and a timer."""
BEGIN_SEC = 0.01
"""How long the executor waits at most for a thread to start the callback, if all are busy."""


class PromptPool(ThreadPoolExecutor):
    """A thread pool whose `submit` waits until a thread has started the function."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future:
        """Submit a callback, and wait until a thread has started it, at most BEGIN_SEC."""
        started = threading.Event()

        def begin() -> Any:
            started.set()
            return fn(*args, **kwargs)

        future = super().submit(begin)
        started.wait(BEGIN_SEC)
        return future


def let_threads_begin() -> None:
    """Give such a pool to each MultiThreadedExecutor that is created from now on.

    If the caller does not pass a number of threads, it has THREADS.
    """
    init = MultiThreadedExecutor.__init__

    def prompt_init(
        executor: MultiThreadedExecutor, num_threads: int | None = None, **kwargs: Any
    ) -> None:
        init(executor, THREADS if num_threads is None else num_threads, **kwargs)
        executor._executor = PromptPool(executor._executor._max_workers)

    MultiThreadedExecutor.__init__ = prompt_init  # type: ignore[assignment, method-assign]
