"""Find the exercises of a healed notebook, and plan which of its cells to run for each."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from nbformat import NotebookNode

from my_robot_basics.validate.cells import grade_id, graded_id, is_reset, role
from my_robot_basics.validate.names import names_of, string_arguments
from my_robot_basics.validate.packages import packages_built_by


@dataclass(frozen=True)
class Exercise:
    """One exercise: positions of its cells in the notebook."""

    name: str
    """The grade id of its answer cell."""
    defines: tuple[str, ...]
    """What the answer has to define: the names that its reset cell forgets."""
    reset: int
    answer: int
    run: tuple[int, ...]
    """Locked cells that start what was answered."""
    grades: tuple[int, ...]
    packages: tuple[str, ...] = ()
    """ROS packages that its locked cells build: their folders are the answer."""


@dataclass(frozen=True)
class Plan:
    """Which student cells to run, in order, before an exercise is judged."""

    cells: tuple[int, ...]
    why: str
    demonstrations: tuple[int, ...] = ()
    """Those of them that the lesson shows, run for the names that they bind."""


def find_exercises(notebook: NotebookNode) -> tuple[Exercise, ...]:
    """Return the exercises in the notebook's order; each begins with its `<id>-reset` cell.

    Where an answer cell was taken away there is no exercise.
    """
    starts = [i for i, cell in enumerate(notebook.cells) if is_reset(cell)]
    spans = [range(*span) for span in pairwise([*starts, len(notebook.cells)])]
    return tuple(
        _exercise(notebook, span, answer) for span in spans if (answer := _answer(notebook, span))
    )


def plans(notebook: NotebookNode, exercise: Exercise) -> Iterator[Plan]:
    """Yield what to run, least first: the answer alone, with what it missing, the whole lesson.

    The first plan is left out where the text shows already that the answer needs a name that
    only another of the student's cells binds. Demonstrations come with the names that they bind:
    a function asks for a name only when it is called, and then it is too late to run more.
    Where a package is the answer, there is one plan, which has no cell of the student's: what runs
    of theirs is what is started of the package.
    """
    cells = notebook.cells
    own = (exercise.reset, exercise.answer, *exercise.run)
    setup = [i for i, cell in enumerate(cells) if role(cell) == 'setup' and i < exercise.reset]
    if exercise.packages:
        ours = (i for i in own if role(cells[i]) == 'locked')
        yield Plan(tuple(sorted({*setup, *ours})), why='the package alone')
        return
    missing = _missing(cells, exercise, setup)
    others = [
        i
        for i, cell in enumerate(cells)
        if i != exercise.answer
        and _is_students(cell)
        and (i < _end(exercise) or names_of(cell.source).bound & missing)
    ]
    alone = {*setup, *own}
    if names_of(cells[exercise.answer].source).needs_more:
        yield _with_all_shown(cells, exercise)
    elif not others or not _binds_what_is_missing(cells, others, missing):
        yield _with_what_is_shown(cells, exercise, alone, why='the answer alone')
    if others:
        yield _with_what_is_shown(cells, exercise, alone | {*others}, why='with your other cells')
    whole = [i for i, cell in enumerate(cells) if _is_code(cell) and not _is_apart(cell)]
    yield Plan(
        cells=tuple(i for i in whole if role(cells[i]) not in ('grade', 'locked') or i in own),
        why='the whole lesson',
    )


def plan_for_names(
    notebook: NotebookNode, exercise: Exercise, plan: Plan, names: set[str]
) -> Plan | None:
    """Plan the answer with what binds names that it turned out to need, and all that is shown.

    None where no cell that was left out binds one of them.
    """
    cells = notebook.cells
    more = _with_all_shown(cells, exercise)
    binds = {i for i, cell in enumerate(cells) if _is_code(cell) and _binds(cell, names)}
    others = {i for i in binds if _is_students(cells[i])}
    if not (binds & {*more.cells, *others}) - {*plan.cells}:
        return None
    return Plan(tuple(sorted({*more.cells, *others})), why='with what binds a name that it needs')


def _with_all_shown(cells: list[NotebookNode], exercise: Exercise) -> Plan:
    """Plan the answer after all that the lesson shows before it.

    So it is where a text looks names up by other means: which it will need, nobody can know.
    """
    before = [i for i in range(exercise.reset) if role(cells[i]) in ('demo', 'setup')]
    shown = [i for i in before if _is_code(cells[i]) and not _is_apart(cells[i])]
    own = (exercise.reset, exercise.answer, *exercise.run)
    return Plan((*shown, *own), why='with all that the lesson shows')


def _binds(cell: NotebookNode, names: set[str]) -> bool:
    return bool(names_of(cell.source).bound & names)


def _answer(notebook: NotebookNode, span: range) -> int | None:
    name = graded_id(notebook.cells[span.start]).removesuffix('-reset')
    return next((i for i in span if grade_id(notebook.cells[i]) == name), None)


def _exercise(notebook: NotebookNode, span: range, answer: int) -> Exercise:
    cells = notebook.cells
    name = graded_id(cells[span.start]).removesuffix('-reset')
    return Exercise(
        name=name,
        defines=string_arguments(cells[span.start].source, 'reset'),
        reset=span.start,
        answer=answer,
        run=tuple(i for i in span[1:] if role(cells[i]) == 'locked'),
        grades=tuple(i for i in span if role(cells[i]) == 'grade' and _is_code(cells[i])),
        packages=tuple(name for i in span for name in packages_built_by(cells[i])),
    )


def _end(exercise: Exercise) -> int:
    return max((exercise.answer, *exercise.run, *exercise.grades))


def _missing(cells: list[NotebookNode], exercise: Exercise, setup: list[int]) -> frozenset[str]:
    """Names that the answer needs, or owes, and that neither it nor the setup binds."""
    answer = names_of(cells[exercise.answer].source)
    return (answer.needed | set(exercise.defines)) - answer.bound - _bound(cells, setup)


def _binds_what_is_missing(
    cells: list[NotebookNode], others: list[int], missing: frozenset[str]
) -> bool:
    """Whether one of these cells binds a name that is lacking, as far as its text tells."""
    names = [names_of(cells[i].source) for i in others]
    return bool(missing) and any(each.binds_more or each.bound & missing for each in names)


def _with_what_is_shown(
    cells: list[NotebookNode], exercise: Exercise, chosen: set[int], *, why: str
) -> Plan:
    """Plan the chosen cells, and what the lesson shows that binds a name which they need."""
    shown = [i for i, c in enumerate(cells) if _is_code(c) and role(c) in ('demo', 'setup')]
    demonstrations: set[int] = set()
    todo = [(exercise.answer, names_of(cells[i].source).needed) for i in chosen]
    while todo:
        place, needed = todo.pop()
        for name in needed - _bound(cells, chosen | demonstrations):
            binding = [i for i in shown if name in names_of(cells[i].source).bound]
            # of several, the one that ran last when the lesson was read from top to bottom
            nearest = [i for i in binding if i < place][-1:] or binding[:1]
            demonstrations.update(nearest)
            todo += [(i, names_of(cells[i].source).needed) for i in nearest]
    return Plan(tuple(sorted(chosen | demonstrations)), why, tuple(sorted(demonstrations)))


def _bound(cells: list[NotebookNode], indexes: Iterable[int]) -> set[str]:
    return set().union(*(names_of(cells[i].source).bound for i in indexes))


def _is_students(cell: NotebookNode) -> bool:
    return _is_code(cell) and role(cell) in ('free', 'answer')


def _is_apart(cell: NotebookNode) -> bool:
    """Whether the lesson writes or runs a program in this cell: it binds no name."""
    return role(cell) in ('demo', 'setup') and cell.source.startswith(('%%bash', '%%write_node'))


def _is_code(cell: NotebookNode) -> bool:
    return cell.cell_type == 'code'
