"""Run coroutines of many submissions at a time, on an event loop in a separate thread."""

import asyncio
import signal
import sys
import threading
from collections.abc import Awaitable, Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any, Self, TypeVar

Result = TypeVar('Result')


class Pool:
    """Runs what is submitted, at most `in_flight` at a time; the end of `with` cancels the rest.

    May be used inside a running event loop, because its own loop runs in another thread.
    """

    def __init__(self, in_flight: int) -> None:
        """Take how many may run at a time."""
        self._gate = asyncio.Semaphore(in_flight)
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._serve, name='pool', daemon=True)

    def __enter__(self) -> Self:
        """Start the loop."""
        self._thread.start()
        self._ready.wait()
        return self

    def __exit__(self, *_: object) -> None:
        """Cancel what still runs, let it clean up, and end the loop."""
        with _answering_interrupts():
            self._loop.call_soon_threadsafe(self._left.set)
            self._thread.join()

    def submit(
        self, work: Callable[..., Awaitable[Result]], *args: Any, **kwargs: Any
    ) -> 'Future[Result]':
        """Await `work(...)` when there is room; the future gets its result."""
        return asyncio.run_coroutine_threadsafe(self._in_turn(work, args, kwargs), self._loop)

    async def _in_turn(
        self, work: Callable[..., Awaitable[Result]], args: tuple, kwargs: dict
    ) -> Result:
        async with self._gate:
            return await work(*args, **kwargs)

    def _serve(self) -> None:
        asyncio.run(self._until_left())  # at its end, it cancels unfinished tasks

    async def _until_left(self) -> None:
        self._loop, self._left = asyncio.get_running_loop(), asyncio.Event()
        self._ready.set()
        await self._left.wait()


@contextmanager
def _answering_interrupts() -> Iterator[None]:
    """Print a message on another Ctrl-C: an interrupt would leave kernels behind."""
    if threading.current_thread() is not threading.main_thread():
        yield  # Python handles signals only in the main thread
        return

    def answer(*_: object) -> None:
        print('\nstill ending what was running: a few seconds more', file=sys.stderr)

    former = signal.signal(signal.SIGINT, answer)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, former)
