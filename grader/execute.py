"""Student cells run in the one kernel, grade cells in the other; each exercise is judged alone."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import nbformat
from nbformat import NotebookNode

from grader.errors import RoomFailure
from grader.exercises import Exercise, Plan, find_exercises, plans
from grader.heal import KEY, grade_id, role
from grader.outputs import CellRun
from grader.pool import Pool
from grader.rooms import Rooms
from grader.verdict import Verdict, judge, ungraded, write_verdict

STUDENT_CELL_TIMEOUT_SEC = 10.0
STUDENT_CELLS_BUDGET_SEC = 120.0
"""The most that all student cells of a notebook may take together."""


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


def execute(
    notebook: NotebookNode, *, extra_files: Sequence[Path] = (), seed: str = ''
) -> Execution:
    """Run a healed notebook's exercises, each in rooms of its own, and judge them.

    `seed` decides the inputs that hidden tests choose. May be called inside a running event loop.
    Nothing that a notebook does raises here; what the grader itself fails in is `ungraded`.
    """
    with Pool(in_flight=1) as pool:
        return pool.submit(executed, notebook, extra_files=extra_files, seed=seed).result()


async def executed(
    notebook: NotebookNode, *, extra_files: Sequence[Path] = (), seed: str = ''
) -> Execution:
    """Do what `execute` does, on the running event loop."""
    graded = nbformat.from_dict(notebook)
    if problem := graded.metadata.get(KEY, {}).get('problem'):
        verdicts = _refuse(graded, problem)
    else:
        verdicts = await _execute(graded, tuple(extra_files), seed)
    by_hand = [_by_hand(c) for c in graded.cells if role(c) == 'answer' and _points(c)]
    return Execution(
        notebook=graded,
        verdicts=tuple(verdicts + by_hand),
        notes=tuple(graded.metadata.get(KEY, {}).get('notes', ())),
    )


def _refuse(notebook: NotebookNode, problem: str) -> list[Verdict]:
    """Fail every grade cell of a notebook that could not be read, without running anything."""
    verdicts = []
    for cell in notebook.cells:
        if role(cell) == 'grade' and cell.cell_type == 'code':
            verdicts.append(
                Verdict(grade_id(cell), outcome='failed', points=_points(cell), reason=problem)
            )
            write_verdict(cell, verdicts[-1], [])
    return verdicts


async def _execute(notebook: NotebookNode, files: tuple[Path, ...], seed: str) -> list[Verdict]:
    budget = _Budget()
    verdicts = []
    for exercise in find_exercises(notebook):
        verdicts += await _judge_exercise(notebook, exercise, files, seed, budget)
    return verdicts


async def _judge_exercise(
    notebook: NotebookNode,
    exercise: Exercise,
    files: tuple[Path, ...],
    seed: str,
    budget: _Budget,
) -> list[Verdict]:
    """Judge one exercise; where the grader itself fails, once more in fresh rooms."""
    failure: RoomFailure | None = None
    for _ in range(2):
        try:
            return await _try_plans(notebook, exercise, files, seed, budget)
        except RoomFailure as error:
            failure = error
    verdicts = [ungraded(notebook.cells[i], str(failure)) for i in exercise.grades]
    for index, verdict in zip(exercise.grades, verdicts, strict=True):
        write_verdict(notebook.cells[index], verdict, [])
    return verdicts


async def _try_plans(
    notebook: NotebookNode,
    exercise: Exercise,
    files: tuple[Path, ...],
    seed: str,
    budget: _Budget,
) -> list[Verdict]:
    todo = list(plans(notebook, exercise))
    for number, plan in enumerate(todo, start=1):
        async with Rooms(extra_files=files, seed=seed) as rooms:
            runs = await _run_student_cells(rooms, notebook, plan, budget)
            if number < len(todo) and _lacks_a_name(runs, exercise):
                continue
            for index, run in runs.items():
                notebook.cells[index].outputs = run.outputs
            return [
                await _judge_cell(rooms, notebook, index, runs, exercise)
                for index in exercise.grades
            ]
    raise AssertionError('an exercise always has a last plan')


async def _run_student_cells(
    rooms: Rooms, notebook: NotebookNode, plan: Plan, budget: _Budget
) -> dict[int, CellRun]:
    return {i: await budget.run(rooms, notebook.cells[i].source) for i in plan.cells}


async def _judge_cell(
    rooms: Rooms,
    notebook: NotebookNode,
    index: int,
    runs: dict[int, CellRun],
    exercise: Exercise,
) -> Verdict:
    cell = notebook.cells[index]
    own = [(grade_id(notebook.cells[i]), runs[i]) for i in (exercise.answer, *exercise.run)]
    run = await rooms.run_check(cell.source) if rooms.student_alive else None
    verdict = judge(cell, run, own)
    write_verdict(cell, verdict, run.outputs if run else [])
    return verdict


def _lacks_a_name(runs: dict[int, CellRun], exercise: Exercise) -> bool:
    """Whether the answer, or starting it, stopped for want of a name."""
    return any(
        runs[i].error is not None and runs[i].error.ename == 'NameError'
        for i in (exercise.answer, *exercise.run)
    )


def _by_hand(cell: NotebookNode) -> Verdict:
    return Verdict(grade_id(cell), outcome='manual', points=_points(cell), reason='')


def _points(cell: NotebookNode) -> float:
    return float(cell.metadata.nbgrader.get('points', 0)) if cell.metadata.nbgrader.grade else 0.0
