"""Let a MultiThreadedExecutor's threads begin, and have enough of them, on any machine.

rclpy of Jazzy keeps them waiting. From handing a callback to its pool until a thread there begins
it, that executor does not wait but goes round: it hands the callback over again, and its wait set
returns at once: the subscription is left out, but not its QoS events, and Fast DDS has one
condition for both. Python lets another thread in during each of these waits, some 10 µs long. A
thread that takes longer to wake up comes too late, again and again; and since it was woken before
its wait timed out, it does not make the first one give way. On an idle machine up to half of the
messages came seconds late.
See https://github.com/ros2/rclpy/issues/1452, which is fixed in later releases.

By default there are as many threads as processors. Callbacks that wait keep a thread each, so an
answer would be right on one machine and block on a smaller one: here, each machine has the
same number.
"""

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from rclpy.executors import MultiThreadedExecutor

THREADS = 4
"""Enough for two calls that wait, one whose answer never comes, and a timer."""
BEGIN_SEC = 0.01
"""How long the executor waits at most: while all threads are busy, others are served so often."""


class PromptPool(ThreadPoolExecutor):
    """A pool in which what is handed in begins before the one who does so goes on."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future:
        """Hand in a callback, and wait until a thread has begun it, or for BEGIN_SEC."""
        started = threading.Event()

        def begin() -> Any:
            started.set()
            return fn(*args, **kwargs)

        future = super().submit(begin)
        started.wait(BEGIN_SEC)
        return future


def let_threads_begin() -> None:
    """Give such a pool to each MultiThreadedExecutor that is made from now on.

    Where its maker names no number of threads, it has THREADS of them.
    """
    init = MultiThreadedExecutor.__init__

    def prompt_init(
        executor: MultiThreadedExecutor, num_threads: int | None = None, **kwargs: Any
    ) -> None:
        init(executor, THREADS if num_threads is None else num_threads, **kwargs)
        executor._executor = PromptPool(executor._executor._max_workers)

    MultiThreadedExecutor.__init__ = prompt_init  # type: ignore[assignment, method-assign]
