"""The time that all student cells of a notebook may take together."""

import asyncio
from dataclasses import dataclass, field
from typing import Any, Generic

from nbformat import NotebookNode

from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.limits import (
    BUILD_TIMEOUT_SEC,
    STUDENT_CELL_TIMEOUT_SEC,
    STUDENT_CELLS_BUDGET_SEC,
)
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.rooms_interface import R
from my_robot_basics.validate.lessons.packages import packages_built_by


@dataclass
class Budget(Generic[R]):
    """The remaining time for the student cells of a notebook, in seconds."""

    remaining_sec: float = STUDENT_CELLS_BUDGET_SEC
    loop_time: Any = field(default_factory=lambda: asyncio.get_running_loop().time)

    async def run(self, rooms: R, cell: NotebookNode) -> CellRun:
        """Run one of the student's cells within its limit and the remaining time.

        Raises RoomFailure if a package was not built in time: a slow machine may be the reason.
        """
        if packages := packages_built_by(cell):
            run = await self.run_within(BUILD_TIMEOUT_SEC, rooms, cell)
            if run.timed_out and not run.flooded:
                names, most = ', '.join(packages), f'{BUILD_TIMEOUT_SEC:g} s'
                raise RoomFailure(f'{names} was not built within {most}')
            return run
        start = self.loop_time()
        timeout_sec = max(0.1, min(STUDENT_CELL_TIMEOUT_SEC, self.remaining_sec))
        run = await self.run_within(timeout_sec, rooms, cell)
        self.remaining_sec -= self.loop_time() - start
        return run

    async def run_within(self, timeout_sec: float, rooms: R, cell: NotebookNode) -> CellRun:
        """Run one of the student's cells for at most `timeout_sec`."""
        return await rooms.run_student_cell(cell.source, timeout_sec=timeout_sec)
