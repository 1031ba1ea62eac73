"""How long a cell is waited for: time that nobody could use does not count."""

import asyncio
from collections.abc import Awaitable, Callable

from my_robot_basics.session import pressure
from my_robot_basics.validate.limits import INTERRUPT_GRACE_SEC, INTERRUPT_MOST_SEC

LOOK_EVERY_SEC = 0.2

IsAlive = Callable[[], Awaitable[bool]]
"""Whether the kernel lives."""


async def finished(
    done: asyncio.Future,
    timeout_sec: float,
    is_alive: IsAlive,
    is_enough: Callable[[], bool] = lambda: False,
) -> bool:
    """Wait for a cell's end, or its kernel's; False where its time limit came first, or enough.

    What counts is time in which we could look: a grader that stood still for seconds, on a
    machine that was too busy, has not seen the cell take them.
    """
    left_sec = timeout_sec
    while not done.done():
        if left_sec <= 0 or is_enough():
            return False
        tick_sec = min(LOOK_EVERY_SEC, left_sec)
        await asyncio.wait([done], timeout=tick_sec)
        left_sec -= tick_sec
        if not done.done() and not await is_alive():
            await asyncio.wait([done], timeout=0.2)  # what it said last may be under way
            return True
    await done
    return True


async def finished_in_grace(done: asyncio.Future, is_alive: IsAlive) -> bool:
    """Wait for the end of a cell that was interrupted, while processors are free for it."""
    watch = pressure.Stopwatch()
    while not await finished(done, LOOK_EVERY_SEC, is_alive):
        if watch.free_sec() >= INTERRUPT_GRACE_SEC or watch.wall_sec() >= INTERRUPT_MOST_SEC:
            return False
    return True
