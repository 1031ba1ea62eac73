"""A second attempt at an exercise if the machine, or a check itself, may have caused a failure.

A check reports this doubt by the exception that it raises. Such a failure costs points only after
a second attempt in fresh rooms, and only if nothing but the answer can be the reason then.
"""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Generic

from my_robot_basics.session.pressure import Stopwatch
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.rooms_interface import OpenRooms, R

STARVED, DISTURBED = 'Starved', 'Disturbed'
"""Names of the exceptions that express doubt: both are in `feedback.errors`."""
BUSY_SHARE = 0.25
"""Part of one processor: a student's room that uses more during a check causes its own delays.
A node that publishes now and then needs a tenth of that."""
BUSY_LOOK_SEC = 1.0
"""How long to measure, with the student's room closed, whether others keep the machine busy."""
STALLED_SHARE = 0.5
"""The machine counts as busy if processes wait for a processor for this part of that time."""
LEAVE_CLOCKS = '''"""The nodes' clocks are left alone"""
from my_robot_basics.checks.clock import clock_use

clock_use.leave_alone()
'''


class Doubt(RoomFailure):
    """A check failed, and perhaps not because of the answer."""

    def __init__(self, kind: str, said: str, *, leaves_clocks: bool) -> None:
        """Store the exception's name and text, and how to run the second attempt."""
        self.leaves_clocks = leaves_clocks
        why = 'the check disturbed it' if kind == DISTURBED else 'the machine was too busy'
        super().__init__(f'{why} ({said.strip()})')


class Attempts(Generic[R]):
    """The attempts at one exercise, and which doubts each of them still accepts."""

    def __init__(self, open_rooms: OpenRooms[R]) -> None:
        """Prepare the first attempt, which accepts both doubts."""
        self._open_rooms = open_rooms
        self._doubted: tuple[str, ...] = (STARVED, DISTURBED)
        self._leaves_clocks = False

    async def end(self, failure: RoomFailure) -> None:
        """Prepare the next attempt; no room of the exercise may be open."""
        self._leaves_clocks = isinstance(failure, Doubt) and failure.leaves_clocks
        self._doubted = (STARVED,) if await is_machine_busy() else ()

    @asynccontextmanager
    async def rooms(self) -> AsyncIterator[R]:
        """Open rooms for this attempt."""
        async with self._open_rooms() as rooms:
            if self._leaves_clocks:
                await rooms.run_check(LEAVE_CLOCKS)
            yield rooms

    async def run_check(self, rooms: R, source: str) -> CellRun:
        """Run a grade cell. Raises Doubt if something else than the answer may be the reason."""
        watch, used_sec = Stopwatch(), rooms.student_cpu_sec()
        run = await rooms.run_check(source)
        kind = run.error.ename if run.error else ''
        by_itself = kind == STARVED and (
            _sec_since(used_sec, rooms.student_cpu_sec()) > BUSY_SHARE * watch.wall_sec()
        )
        # a fast simulated clock keeps a correct node busy, too: blame it only without that clock
        is_to_blame = by_itself and self._leaves_clocks
        # a machine that was free between the attempts may have been busy in both
        is_doubted = kind in self._doubted or (kind == STARVED and watch.is_busy())
        if run.error and is_doubted and not is_to_blame:
            leaves_clocks = by_itself or kind == DISTURBED
            raise Doubt(kind, run.error.evalue, leaves_clocks=leaves_clocks)
        return run


async def is_machine_busy() -> bool:
    """Whether processes wait for a processor for most of BUSY_LOOK_SEC, while no answer runs."""
    watch = Stopwatch()
    await asyncio.sleep(BUSY_LOOK_SEC)
    return watch.free_sec() <= (1.0 - STALLED_SHARE) * watch.wall_sec()


def _sec_since(before_sec: float | None, after_sec: float | None) -> float:
    return 0.0 if before_sec is None or after_sec is None else after_sec - before_sec
