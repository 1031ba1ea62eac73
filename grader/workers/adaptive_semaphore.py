"""How many submissions are graded at a time, depending on how busy Linux says the CPUs are."""

import asyncio
from typing import Self

from my_robot_basics.session import pressure

from grader.sandbox.limits import BUSY_SHARE, IDLE_SHARE

LOOK_SEC = 5.0
"""Interval between changes: the effect of one has to show before the next one."""


class AdaptiveSemaphore:
    """A semaphore for `async with`: it admits `least` at a time, and more while CPUs are idle.

    Every LOOK_SEC, when one leaves, it checks in which share of that time some process waited for
    a CPU. If the share is small, `step` more are admitted, up to `most`; if it is large, `step`
    fewer. If Linux does not report it, `least` are admitted. Use it on one event loop only.
    """

    def __init__(self, *, least: int, most: int, step: int) -> None:
        self.allowed = least
        self._least, self._most, self._step = least, most, step
        self._places = asyncio.Semaphore(least)
        self._too_many = 0
        self._begin_look()

    async def __aenter__(self) -> Self:
        """Wait for a place."""
        await self._places.acquire()
        return self

    async def __aexit__(self, *_: object) -> None:
        """Release the place, and check how busy the machine is."""
        stalled_sec, wall_sec = pressure.stalled_sec(), self._watch.wall_sec()
        if wall_sec >= LOOK_SEC and stalled_sec:
            self._follow((stalled_sec - self._stalled_sec) / wall_sec)
            self._begin_look()
        self._give(1)

    def _begin_look(self) -> None:
        self._watch, self._stalled_sec = pressure.Stopwatch(), pressure.stalled_sec()

    def _follow(self, stalled_share: float) -> None:
        before = self.allowed
        if stalled_share < IDLE_SHARE:
            self.allowed = min(before + self._step, self._most)
            self._give(self.allowed - before)
        elif stalled_share > BUSY_SHARE:
            self.allowed = max(before - self._step, self._least)
            self._too_many += before - self.allowed

    def _give(self, places: int) -> None:
        """Release places, except as many as have to be removed."""
        kept = min(self._too_many, places)
        self._too_many -= kept
        for _ in range(places - kept):
            self._places.release()
