"""How long a cell is waited for: time that nobody could use does not count."""

import asyncio
from collections.abc import Awaitable, Callable

from my_robot_basics.session import pressure
from my_robot_basics.validate.limits import INTERRUPT_GRACE_SEC, INTERRUPT_MOST_SEC

LOOK_EVERY_SEC = 0.2
MOST_TIMES = 3.0
"""How many times its limit a cell may take at most, on a busy machine. …"""
ASLEEP_PART = 0.01
"""… Code that works gets more than this part of a processor, however busy the machine is."""

IsAlive = Callable[[], Awaitable[bool]]
"""Whether the kernel lives."""
UsedSec = Callable[[], float | None]
"""How long the code has kept processors busy so far; None if nobody counts."""


async def finished(
    done: asyncio.Future,
    timeout_sec: float,
    is_alive: IsAlive,
    is_enough: Callable[[], bool] = lambda: False,
) -> bool:
    """Wait for a cell's end, or its kernel's; False if its time is over, or `is_enough()`, first.

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
            await asyncio.wait([done], timeout=0.2)  # its last messages may be under way
            return True
    await done
    return True


async def finished_while_served(
    done: asyncio.Future,
    timeout_sec: float,
    is_alive: IsAlive,
    is_enough: Callable[[], bool],
    used_sec: UsedSec,
) -> bool:
    """As `finished`, but code that works and gets too little of a processor has longer.

    It has until it has used `timeout_sec` of a processor, or could have, and MOST_TIMES as long at
    most. Code that waits for anything else uses no processor, and has no longer.
    """
    watch, before_sec = pressure.Stopwatch(), used_sec()
    left_sec = timeout_sec
    while not await finished(done, left_sec, is_alive, is_enough):
        now_sec, wall_sec = used_sec(), watch.wall_sec()
        if is_enough() or before_sec is None or now_sec is None:
            return False
        used, is_over = now_sec - before_sec, wall_sec >= MOST_TIMES * timeout_sec
        if is_over or used < ASLEEP_PART * wall_sec or max(used, watch.free_sec()) >= timeout_sec:
            return False
        left_sec = LOOK_EVERY_SEC
    return True


async def finished_in_grace(done: asyncio.Future, is_alive: IsAlive) -> bool:
    """Wait for the end of a cell that was interrupted, while processors are free for it."""
    watch = pressure.Stopwatch()
    while not await finished(done, LOOK_EVERY_SEC, is_alive):
        if watch.free_sec() >= INTERRUPT_GRACE_SEC or watch.wall_sec() >= INTERRUPT_MOST_SEC:
            return False
    return True
