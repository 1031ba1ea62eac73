"""How long *Validate* waits for each of the student's cells: its advice has to come soon."""

import math
from dataclasses import dataclass

from nbformat import NotebookNode

from my_robot_basics.validate.kernels.limits import VALIDATE_NEXT_TIMEOUT_SEC, VALIDATE_TIMEOUT_SEC
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.lessons.cells import KEY, role
from my_robot_basics.validate.lessons.packages import packages_built_by
from my_robot_basics.validate.running.rooms import LocalRooms
from my_robot_basics.validate.verdicts.budget import Budget

_STUDENTS = ('answer', 'free', 'locked')
"""Roles of the cells whose time is the student's: locked ones run the answer."""


@dataclass
class ShortBudget(Budget[LocalRooms]):
    """The grader's budget with a shorter limit for a cell, even shorter after one was given up."""

    free_sec: float = VALIDATE_TIMEOUT_SEC

    async def run_within(
        self, timeout_sec: float, rooms: LocalRooms, cell: NotebookNode
    ) -> CellRun:
        """Run a cell for at most `timeout_sec`, a student's also for at most `free_sec`."""
        builds = packages_built_by(cell)
        is_theirs = role(cell) in _STUDENTS and not builds
        free_sec = self.free_sec if is_theirs else math.inf
        run = await rooms.run_student_cell(
            cell.source,
            timeout_sec=timeout_sec,
            free_sec=free_sec,
            number=cell.metadata[KEY].number,
            builds=', '.join(builds),
        )
        if run.cut_after_sec:
            self.free_sec = VALIDATE_NEXT_TIMEOUT_SEC
        return run
