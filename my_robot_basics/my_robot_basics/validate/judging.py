"""Run an exercise as its plans say, in rooms that somebody opens, and judge its checks."""

import asyncio
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from dataclasses import dataclass, field
from typing import Any, Protocol

from nbformat import NotebookNode

from my_robot_basics.validate.cells import grade_id
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.exercises import Exercise, Plan, plans
from my_robot_basics.validate.limits import STUDENT_CELL_TIMEOUT_SEC, STUDENT_CELLS_BUDGET_SEC
from my_robot_basics.validate.outputs import CellRun
from my_robot_basics.validate.verdict import Verdict, judge, ungraded


class Rooms(Protocol):
    """Two kernels that share nothing but a ROS domain: the student's and the test's."""

    @property
    def student_alive(self) -> bool:
        """Whether the student's kernel still runs."""

    async def run_student_cell(self, source: str, *, timeout_sec: float) -> CellRun:
        """Run one of the student's cells."""

    async def run_check(self, source: str) -> CellRun:
        """Run a grade cell, passing its questions on to the student's kernel."""


OpenRooms = Callable[[], AbstractAsyncContextManager[Rooms]]


@dataclass
class Budget:
    """What is left of the time that all student cells of a notebook may take together."""

    remaining_sec: float = STUDENT_CELLS_BUDGET_SEC
    loop_time: Any = field(default_factory=lambda: asyncio.get_running_loop().time)

    async def run(self, rooms: Rooms, source: str) -> CellRun:
        """Run one of the student's cells within its limit, and within what is left."""
        start = self.loop_time()
        timeout_sec = max(0.1, min(STUDENT_CELL_TIMEOUT_SEC, self.remaining_sec))
        run = await rooms.run_student_cell(source, timeout_sec=timeout_sec)
        self.remaining_sec -= self.loop_time() - start
        return run


@dataclass(frozen=True)
class Judged:
    """What came of one exercise; cells are known by their place in the notebook."""

    runs: dict[int, CellRun]
    """Of the student's cells; empty where the rooms failed."""
    checks: dict[int, tuple[Verdict, list[NotebookNode]]]
    """Of each grade cell, with its outputs."""


async def judge_exercise(
    notebook: NotebookNode, exercise: Exercise, open_rooms: OpenRooms, budget: Budget
) -> Judged:
    """Judge one exercise; where the rooms fail, once more in fresh ones.

    Where they fail again its checks are `ungraded`.
    """
    failure: RoomFailure | None = None
    for _ in range(2):
        try:
            return await _try_plans(notebook, exercise, open_rooms, budget)
        except RoomFailure as error:
            failure = error
    cells = notebook.cells
    return Judged({}, {i: (ungraded(cells[i], str(failure)), []) for i in exercise.grades})


async def _try_plans(
    notebook: NotebookNode, exercise: Exercise, open_rooms: OpenRooms, budget: Budget
) -> Judged:
    cells = notebook.cells
    todo = list(plans(notebook, exercise))
    for number, plan in enumerate(todo, start=1):
        async with open_rooms() as rooms:
            runs = {i: await budget.run(rooms, cells[i].source) for i in plan.cells}
            if number < len(todo) and _lacks_a_name(runs, exercise, plan):
                continue
            own = [(grade_id(cells[i]), runs[i]) for i in (exercise.answer, *exercise.run)]
            checks = {i: await _judge_cell(cells[i], rooms, own) for i in exercise.grades}
            return Judged(runs, checks)
    raise AssertionError('an exercise always has a last plan')


async def _judge_cell(
    cell: NotebookNode, rooms: Rooms, own: list[tuple[str, CellRun]]
) -> tuple[Verdict, list[NotebookNode]]:
    run = await rooms.run_check(cell.source) if rooms.student_alive else None
    return judge(cell, run, own), run.outputs if run else []


def _lacks_a_name(runs: dict[int, CellRun], exercise: Exercise, plan: Plan) -> bool:
    """Whether the answer, or starting it, stopped for want of a name, or may when it is called."""
    if not all(runs[i].ran_to_end for i in plan.borrowed):
        return True  # what the lesson shows may need more than names
    return any(
        runs[i].error is not None and runs[i].error.ename == 'NameError'
        for i in (exercise.answer, *exercise.run)
    )
