"""Run student cells in one kernel and grade cells in another, separately for each exercise."""

import asyncio
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import nbformat
from my_robot_basics.validate.kernels.limits import MAX_NOTEBOOK_OUTPUT_CHARACTERS
from my_robot_basics.validate.lessons.cells import KEY, grade_id, role
from my_robot_basics.validate.lessons.exercises import Exercise, find_exercises
from my_robot_basics.validate.together import gather_or_cancel
from my_robot_basics.validate.verdicts.budget import Budget
from my_robot_basics.validate.verdicts.judging import JudgedExercise, judge_exercise
from my_robot_basics.validate.verdicts.side_by_side import join_judged, split_exercise
from my_robot_basics.validate.verdicts.verdict import Verdict, fail_all_checks, write_verdict
from nbformat import NotebookNode

from grader.common.pool import Pool
from grader.judging.local_paths import hide_local_paths
from grader.kernels.isolation import require_isolation
from grader.kernels.rooms import GradingRooms

SIDE_BY_SIDE = 2
"""Exercises of a notebook, or parts of them, that run at a time, if this process grades no other
notebook: they wait more than they work. If it grades several, notebooks run at a time instead."""
_under_way = 0
OUTPUT_CHARACTERS = 400
"""What each output counts in addition to its text, so that some 8,000 small ones are kept."""
PART_CHARACTERS = 40
"""What each object and list in an output counts: a worker's result may have 200,000 of them."""


@dataclass(frozen=True)
class Execution:
    """A graded notebook."""

    notebook: NotebookNode
    """With the outputs of the student's cells, and a verdict in each grade cell."""
    verdicts: tuple[Verdict, ...]
    notes: tuple[str, ...]
    """What was restored in the notebook before it ran."""


@dataclass
class _OutputSpace:
    """How many characters are left for the outputs of all cells of a notebook."""

    characters: int = MAX_NOTEBOOK_OUTPUT_CHARACTERS

    def fit(self, outputs: list[NotebookNode]) -> list[NotebookNode]:
        """Return a cell's outputs if there is room for them, else a message that there is not."""
        size = len(str(outputs)) + OUTPUT_CHARACTERS * len(outputs)
        size += PART_CHARACTERS * _parts(outputs)
        if size <= self.characters:
            self.characters -= size
            return outputs
        most = f'{MAX_NOTEBOOK_OUTPUT_CHARACTERS:,}'
        text = f'[not kept: all cells together printed more than {most} characters]\n'
        return [nbformat.v4.new_output('stream', name='stdout', text=text)]


def _parts(found: object) -> int:
    """Count objects and lists, nested ones included; outputs are not nested deeply."""
    if not isinstance(found, dict | list):
        return 0
    return 1 + sum(map(_parts, found.values() if isinstance(found, dict) else found))


@dataclass(frozen=True)
class _NotebookRun:
    """What all exercises of one notebook have in common."""

    notebook: NotebookNode
    files: tuple[Path, ...]
    seed: str
    isolated: bool
    budget: Budget
    space: _OutputSpace = field(default_factory=_OutputSpace)

    def rooms(self, doubts: list[str]) -> GradingRooms:
        return GradingRooms(
            extra_files=self.files, seed=self.seed, isolated=self.isolated, doubts=doubts
        )

    def write(self, index: int, verdict: Verdict, outputs: Sequence[NotebookNode]) -> Verdict:
        write_verdict(self.notebook.cells[index], verdict, outputs)
        return verdict


def execute(
    notebook: NotebookNode,
    *,
    extra_files: Sequence[Path] = (),
    seed: str = '',
    trust_students: bool = False,
) -> Execution:
    """Run a restored notebook's exercises, each in rooms of its own, and judge them.

    `seed` decides the inputs that hidden tests choose. May be called inside a running event loop.
    Nothing that a notebook does raises an exception here; if the grader itself fails, the verdict
    is `ungraded`. Raises CourseError if there is no sandbox, unless `trust_students`.
    """
    options = {'extra_files': extra_files, 'seed': seed, 'trust_students': trust_students}
    with Pool(in_flight=1) as pool:
        return pool.submit(execute_exercises, notebook, **options).result()


async def execute_exercises(
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
        verdicts = fail_all_checks(graded, problem)
    else:
        in_sandbox = require_isolation(trust_students=trust_students)
        graded.metadata[KEY].in_sandbox = in_sandbox
        verdicts = await _execute(
            _NotebookRun(graded, tuple(extra_files), seed, in_sandbox, Budget())
        )
    hide_local_paths(graded)
    by_hand = [_by_hand(c) for c in graded.cells if role(c) == 'answer' and _points(c)]
    return Execution(
        notebook=graded,
        verdicts=tuple(verdicts + by_hand),
        notes=tuple(graded.metadata.get(KEY, {}).get('notes', ())),
    )


async def _execute(work: _NotebookRun) -> list[Verdict]:
    verdicts = []
    with _count_running() as others:
        places = asyncio.Semaphore(1 if others else SIDE_BY_SIDE)
        exercises = [
            (exercise,) if others else split_exercise(work.notebook, exercise)
            for exercise in find_exercises(work.notebook)
        ]
        in_order = await gather_or_cancel(*(_judge(work, parts, places) for parts in exercises))
    for judged in in_order:
        for index, run in judged.runs.items():
            work.notebook.cells[index].outputs = work.space.fit(run.outputs)
        verdicts += [work.write(index, *check) for index, check in judged.checks.items()]
    return verdicts


async def _judge(
    work: _NotebookRun, parts: Sequence[Exercise], places: asyncio.Semaphore
) -> JudgedExercise:
    async def judge(part: Exercise) -> JudgedExercise:
        async with places:
            rooms = partial(work.rooms, [])
            return await judge_exercise(work.notebook, part, rooms, work.budget)

    return join_judged(await gather_or_cancel(*map(judge, parts)))


@contextmanager
def _count_running() -> Iterator[int]:
    """Count a notebook while it runs; yield how many others this process was running before."""
    global _under_way
    _under_way += 1
    try:
        yield _under_way - 1
    finally:
        _under_way -= 1


def _by_hand(cell: NotebookNode) -> Verdict:
    return Verdict(grade_id(cell) or '', outcome='manual', points=_points(cell), reason='')


def _points(cell: NotebookNode) -> float:
    return float(cell.metadata.nbgrader.get('points', 0)) if cell.metadata.nbgrader.grade else 0.0
