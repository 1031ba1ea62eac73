"""Run an exercise as its plans say, in rooms that the caller opens, and judge its checks."""

import copy
from contextlib import suppress
from dataclasses import dataclass, replace

from nbformat import NotebookNode

from my_robot_basics.feedback import hidden
from my_robot_basics.feedback.hidden_source import mark_hidden_part, without_hidden_part
from my_robot_basics.validate.errors import RoomFailure
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.kernels.rooms_interface import OpenRooms, R, Rooms
from my_robot_basics.validate.lessons.cell_names import number_of
from my_robot_basics.validate.lessons.cells import grade_id, graded_id
from my_robot_basics.validate.lessons.exercises import Exercise
from my_robot_basics.validate.lessons.misspelled import are_misspelled
from my_robot_basics.validate.lessons.names import names_not_defined
from my_robot_basics.validate.lessons.plans import Plan, plan_for_names, plans
from my_robot_basics.validate.verdicts.budget import Budget
from my_robot_basics.validate.verdicts.overdue import judge_overdue
from my_robot_basics.validate.verdicts.second_look import Attempts
from my_robot_basics.validate.verdicts.unanswered import Checks, explain_unanswered
from my_robot_basics.validate.verdicts.verdict import judge, leave_ungraded


@dataclass(frozen=True)
class JudgedExercise:
    """The results of one exercise; keys are the cells' positions in the notebook."""

    runs: dict[int, CellRun]
    """Results of the student's cells; empty if the rooms failed."""
    checks: Checks
    """Verdict and outputs of each grade cell."""


async def judge_exercise(
    notebook: NotebookNode, exercise: Exercise, open_rooms: OpenRooms[R], budget: Budget[R]
) -> JudgedExercise:
    """Judge one exercise; if the rooms fail, once more in fresh ones.

    The same happens if the machine or a check itself may have caused a failure. If the second
    attempt also fails, the verdicts are `ungraded`.
    """
    failure: RoomFailure | None = None
    looks = Attempts(open_rooms)
    for _ in range(2):
        try:
            judged = await _try_plans(notebook, exercise, looks, budget)
            answer = notebook.cells[exercise.answer]
            return replace(judged, checks=explain_unanswered(answer, judged.checks))
        except RoomFailure as error:
            failure = error
            await looks.end(error)
    cells = notebook.cells
    return JudgedExercise(
        {}, {i: (leave_ungraded(cells[i], str(failure)), []) for i in exercise.grades}
    )


async def _try_plans(
    notebook: NotebookNode, exercise: Exercise, looks: Attempts[R], budget: Budget[R]
) -> JudgedExercise:
    todo = list(plans(notebook, exercise))
    for number, plan in enumerate(todo, start=1):
        is_last = number == len(todo)
        judged = await _try_plan(notebook, exercise, plan, looks, budget, is_last=is_last)
        if judged is None:
            continue
        missing = set() if exercise.packages else _missing_names(judged)
        if more := plan_for_names(notebook, exercise, plan, missing):
            again = await _try_plan(notebook, exercise, more, looks, budget, is_last=True)
            assert again is not None  # it was the last plan
            return max(judged, again, key=_points)
        return judged
    raise AssertionError('an exercise always has a last plan')


async def _try_plan(
    notebook: NotebookNode,
    exercise: Exercise,
    plan: Plan,
    looks: Attempts[R],
    budget: Budget[R],
    *,
    is_last: bool,
) -> JudgedExercise | None:
    """Run a plan's cells and judge the exercise; None if a name is missing and plans are left."""
    async with looks.rooms() as rooms:
        # a copy: a display that is updated later, during a check, may show hidden inputs
        runs = copy.deepcopy(await _run_cells(notebook, exercise, plan, rooms, budget))
        if not is_last and _lacks_a_name(notebook, runs, exercise, plan):
            return None
        checks, cut = await _judge_cells(notebook, exercise, looks, rooms, runs)
    if cut:
        with suppress(RoomFailure):  # then the verdicts keep their short reasons
            async with looks.rooms() as rooms:
                await _run_cells(notebook, exercise, plan, rooms, budget)
                checks |= await _explained_in_full(notebook, rooms, {i: checks[i] for i in cut})
    return JudgedExercise(runs, checks)


def _missing_names(judged: JudgedExercise) -> set[str] | None:
    """Return the undefined names that made the answer raise when a check called it.

    None for one that is only in a verdict's details: code that knows hidden inputs may have chosen
    it by them, and the outputs of the cells that bind it would tell the student.
    """
    lost = [verdict for verdict, _ in judged.checks.values() if verdict.outcome != 'passed']
    if any(names_not_defined(verdict.details) for verdict in lost):
        return None
    return set().union(*(names_not_defined(verdict.reason) for verdict in lost))


def _points(judged: JudgedExercise) -> float:
    return sum(verdict.score or 0.0 for verdict, _ in judged.checks.values())


async def _run_cells(
    notebook: NotebookNode, exercise: Exercise, plan: Plan, rooms: R, budget: Budget[R]
) -> dict[int, CellRun]:
    """Run a plan's cells; then the answer and its run cells again if a later cell bound a name.

    This happens if a student adds a helper function below the answer.
    """
    runs = {i: await budget.run(rooms, notebook.cells[i]) for i in plan.cells}
    own = [i for i in (exercise.answer, *exercise.run) if i in runs]
    stopped = [i for i in own if _wants_a_name(runs[i]) and plan.cells[-1] > own[-1]]
    again = own[own.index(stopped[0]) :] if stopped else plan.again
    return runs | {i: await budget.run(rooms, notebook.cells[i]) for i in again}


async def _judge_cells(
    notebook: NotebookNode,
    exercise: Exercise,
    looks: Attempts[R],
    rooms: R,
    runs: dict[int, CellRun],
) -> tuple[Checks, list[int]]:
    """Judge an exercise's grade cells; return verdicts, and the cells with shortened reasons.

    Once the student's code knows hidden inputs, it might reveal them through the visible part of
    a later check: so that one's reason is reduced to its cause, too.
    """
    cells = notebook.cells
    own = [(graded_id(cells[i]), runs[i]) for i in (exercise.answer, *exercise.run) if i in runs]
    given_up = [(_name(cells, i), run) for i, run in runs.items() if run.cut_after_sec]
    checks, cut, quiet = {}, [], False
    for index in exercise.grades:
        source = mark_hidden_part(cells[index].source, quiet=quiet)
        can_tell = rooms.student_alive and not any(each.cut_after_sec for _, each in own)
        run = await looks.run_check(rooms, source) if can_tell else None
        outputs = run.outputs if run else []
        open_ = judge_overdue(cells[index], run, given_up)
        verdict = open_ or judge(cells[index], run, own)
        if quiet and verdict.details and not hidden.has_reached_hidden_part(outputs):
            cut.append(index)
        checks[index] = verdict, [] if quiet else outputs
        quiet = quiet or hidden.has_chosen_inputs(outputs)
    return checks, cut


async def _explained_in_full(notebook: NotebookNode, rooms: Rooms, cut: Checks) -> Checks:
    """Replace shortened reasons by full ones, from rooms whose code knows no hidden inputs."""
    explained = {}
    for index, (verdict, _) in cut.items():
        cell = notebook.cells[index]
        if rooms.student_alive:
            run = await rooms.run_check(mark_hidden_part(without_hidden_part(cell.source)))
            again = judge(cell, run, [])
            if again.outcome == 'failed':
                told = replace(verdict, reason=again.reason, hint=again.hint, details='')
                explained[index] = told, run.outputs
    return explained


def _name(cells: list[NotebookNode], index: int) -> str:
    return f'`{name}`' if (name := grade_id(cells[index])) else f'{number_of(cells, index)}'


def _lacks_a_name(
    notebook: NotebookNode, runs: dict[int, CellRun], exercise: Exercise, plan: Plan
) -> bool:
    """Whether the answer or its run cells stopped at an undefined name that another cell binds.

    Also if a demonstration failed. A name that no other cell can bind is misspelled, not missing.
    """
    if not all(runs[i].ran_to_end for i in plan.demonstrations):
        return True  # a demonstration may need more than the names that were planned for
    wanting = [run for i in (exercise.answer, *exercise.run) if _wants_a_name(run := runs[i])]
    if not wanting:
        return False
    errors = [run.error for run in wanting if run.error]
    names = [names_not_defined(f'{error.ename}: {error.evalue}') for error in errors]
    return not all(names) or not are_misspelled(set().union(*names), notebook, exercise)


def _wants_a_name(run: CellRun) -> bool:
    return run.error is not None and run.error.ename == 'NameError'
