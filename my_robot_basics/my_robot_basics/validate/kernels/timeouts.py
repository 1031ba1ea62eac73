"""Time limits of a cell, which a busy machine extends."""

import asyncio
from collections.abc import Awaitable, Callable

from my_robot_basics.session import pressure
from my_robot_basics.validate.kernels.limits import INTERRUPT_GRACE_SEC, INTERRUPT_MOST_SEC

LOOK_EVERY_SEC = 0.2
MOST_TIMES = 3.0
"""How many times its limit a cell may take at most, on a busy machine."""
ASLEEP_PART = 0.01
"""Part of one processor: code that uses less is waiting; even on a busy machine, running code
gets more."""

IsAlive = Callable[[], Awaitable[bool]]
"""Whether the kernel is alive."""
UsedSec = Callable[[], float | None]
"""The processor time of the code so far, in seconds; None if it is not measured."""


async def wait_for_end(
    done: asyncio.Future,
    timeout_sec: float,
    is_alive: IsAlive,
    is_enough: Callable[[], bool] = lambda: False,
) -> bool:
    """Wait for the end of a cell or its kernel; False if the limit or `is_enough()` comes first.

    Each look counts LOOK_EVERY_SEC at most: if a busy machine stops this process for seconds,
    they do not count against the cell.
    """
    left_sec = timeout_sec
    while not done.done():
        if left_sec <= 0 or is_enough():
            return False
        tick_sec = min(LOOK_EVERY_SEC, left_sec)
        await asyncio.wait([done], timeout=tick_sec)
        left_sec -= tick_sec
        if not done.done() and not await is_alive():
            await asyncio.wait([done], timeout=0.2)  # its last messages may still arrive
            return True
    await done
    return True


async def wait_for_end_by_cpu_time(
    done: asyncio.Future,
    timeout_sec: float,
    is_alive: IsAlive,
    is_enough: Callable[[], bool],
    used_sec: UsedSec,
) -> bool:
    """Like `wait_for_end`, but running code that gets too little of a processor gets more time.

    The limit is `timeout_sec` of processor time, or of time with a free processor, and at most
    MOST_TIMES as long. Code that waits uses no processor and gets no more time.
    """
    watch, before_sec = pressure.Stopwatch(), used_sec()
    left_sec = timeout_sec
    while not await wait_for_end(done, left_sec, is_alive, is_enough):
        now_sec, wall_sec = used_sec(), watch.wall_sec()
        if is_enough() or before_sec is None or now_sec is None:
            return False
        used, is_over = now_sec - before_sec, wall_sec >= MOST_TIMES * timeout_sec
        if is_over or used < ASLEEP_PART * wall_sec or max(used, watch.free_sec()) >= timeout_sec:
            return False
        left_sec = LOOK_EVERY_SEC
    return True


async def wait_for_end_in_grace(done: asyncio.Future, is_alive: IsAlive) -> bool:
    """Wait for an interrupted cell's end: INTERRUPT_GRACE_SEC of time with a free processor."""
    watch = pressure.Stopwatch()
    while not await wait_for_end(done, LOOK_EVERY_SEC, is_alive):
        if watch.free_sec() >= INTERRUPT_GRACE_SEC or watch.wall_sec() >= INTERRUPT_MOST_SEC:
            return False
    return True
