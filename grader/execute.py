"""Student cells run in the one kernel, grade cells in the other; each exercise is judged alone."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import nbformat
from my_robot_basics.validate.cells import KEY, grade_id, role
from my_robot_basics.validate.exercises import Exercise, Plan, find_exercises, plans
from my_robot_basics.validate.limits import STUDENT_CELL_TIMEOUT_SEC, STUDENT_CELLS_BUDGET_SEC
from my_robot_basics.validate.outputs import CellRun
from my_robot_basics.validate.verdict import Verdict, judge, refuse, ungraded, write_verdict
from nbformat import NotebookNode

from grader.errors import RoomFailure
from grader.isolation import TRUSTED, isolated
from grader.pool import Pool
from grader.rooms import Rooms


@dataclass(frozen=True)
class Execution:
    """A graded notebook."""

    notebook: NotebookNode
    """With the outputs of the student's cells, and a verdict in each grade cell."""
    verdicts: tuple[Verdict, ...]
    notes: tuple[str, ...]
    """What was mended in the notebook before it ran."""


@dataclass
class _Budget:
    remaining_sec: float = STUDENT_CELLS_BUDGET_SEC
    loop_time: Any = field(default_factory=lambda: asyncio.get_running_loop().time)

    async def run(self, rooms: Rooms, source: str) -> CellRun:
        start = self.loop_time()
        timeout_sec = max(0.1, min(STUDENT_CELL_TIMEOUT_SEC, self.remaining_sec))
        run = await rooms.run_student_cell(source, timeout_sec=timeout_sec)
        self.remaining_sec -= self.loop_time() - start
        return run


@dataclass(frozen=True)
class _Task:
    """What all exercises of a notebook are judged with."""

    notebook: NotebookNode
    files: tuple[Path, ...]
    seed: str
    isolated: bool
    budget: _Budget

    def rooms(self) -> Rooms:
        return Rooms(extra_files=self.files, seed=self.seed, isolated=self.isolated)

    def write(self, index: int, verdict: Verdict, outputs: Sequence[NotebookNode]) -> Verdict:
        if not self.isolated:
            verdict = replace(verdict, notes=(*verdict.notes, TRUSTED))
        write_verdict(self.notebook.cells[index], verdict, outputs)
        return verdict


def execute(
    notebook: NotebookNode,
    *,
    extra_files: Sequence[Path] = (),
    seed: str = '',
    trust_students: bool = False,
) -> Execution:
    """Run a healed notebook's exercises, each in rooms of its own, and judge them.

    `seed` decides the inputs that hidden tests choose. May be called inside a running event loop.
    Nothing that a notebook does raises here; what the grader itself fails in is `ungraded`.
    Raises CourseError where there is no sandbox, unless told to `trust_students`.
    """
    options = {'extra_files': extra_files, 'seed': seed, 'trust_students': trust_students}
    with Pool(in_flight=1) as pool:
        return pool.submit(executed, notebook, **options).result()


async def executed(
    notebook: NotebookNode,
    *,
    extra_files: Sequence[Path] = (),
    seed: str = '',
    trust_students: bool = False,
) -> Execution:
    """Do what `execute` does, on the running event loop."""
    graded = nbformat.from_dict(notebook)
    graded.metadata.setdefault(KEY, nbformat.from_dict({'notes': []})).seed = seed
    if problem := graded.metadata.get(KEY, {}).get('problem'):
        verdicts = refuse(graded, problem)
    else:
        in_sandbox = isolated(trust_students=trust_students)
        verdicts = await _execute(_Task(graded, tuple(extra_files), seed, in_sandbox, _Budget()))
    by_hand = [_by_hand(c) for c in graded.cells if role(c) == 'answer' and _points(c)]
    return Execution(
        notebook=graded,
        verdicts=tuple(verdicts + by_hand),
        notes=tuple(graded.metadata.get(KEY, {}).get('notes', ())),
    )


async def _execute(task: _Task) -> list[Verdict]:
    verdicts = []
    for exercise in find_exercises(task.notebook):
        verdicts += await _judge_exercise(task, exercise)
    return verdicts


async def _judge_exercise(task: _Task, exercise: Exercise) -> list[Verdict]:
    """Judge one exercise; where the grader itself fails, once more in fresh rooms."""
    failure: RoomFailure | None = None
    for _ in range(2):
        try:
            return await _try_plans(task, exercise)
        except RoomFailure as error:
            failure = error
    cells = task.notebook.cells
    return [task.write(i, ungraded(cells[i], str(failure)), []) for i in exercise.grades]


async def _try_plans(task: _Task, exercise: Exercise) -> list[Verdict]:
    todo = list(plans(task.notebook, exercise))
    for number, plan in enumerate(todo, start=1):
        async with task.rooms() as rooms:
            runs = await _run_student_cells(task, rooms, plan)
            if number < len(todo) and _lacks_a_name(runs, exercise, plan):
                continue
            for index, run in runs.items():
                task.notebook.cells[index].outputs = run.outputs
            own = [
                (grade_id(task.notebook.cells[i]), runs[i])
                for i in (exercise.answer, *exercise.run)
            ]
            return [await _judge_cell(task, rooms, index, own) for index in exercise.grades]
    raise AssertionError('an exercise always has a last plan')


async def _run_student_cells(task: _Task, rooms: Rooms, plan: Plan) -> dict[int, CellRun]:
    cells = task.notebook.cells
    return {i: await task.budget.run(rooms, cells[i].source) for i in plan.cells}


async def _judge_cell(
    task: _Task, rooms: Rooms, index: int, own: list[tuple[str, CellRun]]
) -> Verdict:
    cell = task.notebook.cells[index]
    run = await rooms.run_check(cell.source) if rooms.student_alive else None
    return task.write(index, judge(cell, run, own), run.outputs if run else [])


def _lacks_a_name(runs: dict[int, CellRun], exercise: Exercise, plan: Plan) -> bool:
    """Whether the answer, or starting it, stopped for want of a name, or may when it is called."""
    if not all(runs[i].ran_to_end for i in plan.borrowed):
        return True  # what the lesson shows may need more than names
    return any(
        runs[i].error is not None and runs[i].error.ename == 'NameError'
        for i in (exercise.answer, *exercise.run)
    )


def _by_hand(cell: NotebookNode) -> Verdict:
    return Verdict(grade_id(cell), outcome='manual', points=_points(cell), reason='')


def _points(cell: NotebookNode) -> float:
    return float(cell.metadata.nbgrader.get('points', 0)) if cell.metadata.nbgrader.grade else 0.0
