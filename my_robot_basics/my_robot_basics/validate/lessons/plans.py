"""Plan which student cells to run before an exercise is judged."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from nbformat import NotebookNode

from my_robot_basics.validate.lessons.cells import is_code, role
from my_robot_basics.validate.lessons.exercises import Exercise
from my_robot_basics.validate.lessons.names import names_of


@dataclass(frozen=True)
class Plan:
    """Which student cells to run, in order, before an exercise is judged."""

    cells: tuple[int, ...]
    why: str
    demonstrations: tuple[int, ...] = ()
    """The cells of the lesson itself among them, run for the names that they bind."""
    again: tuple[int, ...] = ()
    """Cells that run the answer, to be run again at the end: a cell below binds a needed name."""


def plans(notebook: NotebookNode, exercise: Exercise) -> Iterator[Plan]:
    """Yield plans, smallest first: the answer alone, with the student's other cells, all cells.

    The first plan is left out if the text already shows that the answer needs a name that only
    another of the student's cells binds. Demonstrations are added for the names that they bind:
    a function reads a name only when it is called, and then it is too late to run more.
    If a package is the answer, there is one plan without any cell of the student's: their code
    runs only as the package's programs.
    """
    cells = notebook.cells
    own = (exercise.reset, exercise.answer, *exercise.run)
    setup = [i for i, cell in enumerate(cells) if role(cell) == 'setup' and i < exercise.reset]
    if exercise.packages:
        ours = (i for i in own if role(cells[i]) == 'locked')
        yield Plan(tuple(sorted({*setup, *ours})), why='the package alone')
        return
    missing = _missing(cells, exercise, setup)
    students = [i for i, c in enumerate(cells) if _is_students(c) and i != exercise.answer]
    lending, _ = _binding_cells(cells, students, missing)
    others = [i for i in students if i < _end(exercise) or i in lending]
    alone = {*setup, *own}
    if names_of(cells[exercise.answer].source).needs_more:
        yield _with_all_shown(cells, exercise)
    elif not others or not _binds_what_is_missing(cells, others, missing):
        yield _with_what_is_shown(cells, exercise, alone, why='the answer alone')
    if others:
        yield _with_what_is_shown(cells, exercise, alone | {*others}, why='with your other cells')
    code = [i for i, cell in enumerate(cells) if is_code(cell) and not _is_apart(cell)]
    whole = tuple(i for i in code if role(cells[i]) not in ('grade', 'locked') or i in own)
    again = _cells_to_rerun(cells, exercise, whole)
    yield Plan(whole, why='the whole lesson', again=again)


def plan_for_names(
    notebook: NotebookNode, exercise: Exercise, plan: Plan, names: set[str] | None
) -> Plan | None:
    """Plan the answer with all demonstrations and the cells that bind the undefined `names`.

    If `names` is None, it is not known which: then all cells that bind any. Returns None if no
    cell that `plan` left out binds one of them.
    """
    cells = notebook.cells
    more = _with_all_shown(cells, exercise)
    binds = {i for i, cell in enumerate(cells) if is_code(cell) and _binds(cell, names)}
    others = {i for i in binds if _is_students(cells[i])}
    if not (binds & {*more.cells, *others}) - {*plan.cells}:
        return None
    chosen = tuple(sorted({*more.cells, *others}))
    names = _bound(cells, others) if names is None else names
    again = _cells_to_rerun(cells, exercise, chosen, names=names)
    return Plan(chosen, why='with what binds a name that it needs', again=again)


def _binding_cells(
    cells: list[NotebookNode], indexes: Iterable[int], names: Iterable[str]
) -> tuple[set[int], set[str]]:
    """Return the cells that bind these names or names that such cells need; and all the names."""
    binders = _binders(cells, indexes)
    lending: set[int] = set()
    met, todo = set[str](), {*names}
    while todo:
        met |= todo
        binding = {i for name in todo for i in binders.get(name, ())} - lending
        lending |= binding
        todo = set().union(*(names_of(cells[i].source).needed for i in binding)) - met
    return lending, met


def _with_all_shown(cells: list[NotebookNode], exercise: Exercise) -> Plan:
    """Plan the answer after all demonstrations before it.

    This is for an answer whose text does not show which names it needs.
    """
    before = [i for i in range(exercise.reset) if role(cells[i]) in ('demo', 'setup')]
    shown = [i for i in before if is_code(cells[i]) and not _is_apart(cells[i])]
    own = (exercise.reset, exercise.answer, *exercise.run)
    return Plan((*shown, *own), why='with all that the lesson shows')


def _binds(cell: NotebookNode, names: set[str] | None) -> bool:
    bound = names_of(cell.source).bound
    return bool(bound if names is None else bound & names)


def _end(exercise: Exercise) -> int:
    return max((exercise.answer, *exercise.run, *exercise.grades))


def _missing(cells: list[NotebookNode], exercise: Exercise, setup: list[int]) -> frozenset[str]:
    """Return names that the answer needs or must define, and that neither it nor setup binds."""
    answer = names_of(cells[exercise.answer].source)
    return (answer.needed | {*exercise.defines} - answer.bound) - _bound(cells, setup)


def _binds_what_is_missing(
    cells: list[NotebookNode], others: list[int], missing: frozenset[str]
) -> bool:
    """Whether one of these cells binds a missing name, or may do so."""
    names = [names_of(cells[i].source) for i in others]
    return bool(missing) and any(each.binds_more or each.bound & missing for each in names)


def _with_what_is_shown(
    cells: list[NotebookNode], exercise: Exercise, chosen: set[int], *, why: str
) -> Plan:
    """Plan the chosen cells, and the demonstrations that bind names which they need."""
    shown = [i for i, c in enumerate(cells) if is_code(c) and role(c) in ('demo', 'setup')]
    binders, bound = _binders(cells, shown), _bound(cells, chosen)
    demonstrations: set[int] = set()
    todo = [(exercise.answer, names_of(cells[i].source).needed) for i in chosen]
    while todo:
        place, needed = todo.pop()
        for name in needed - bound:
            binding = binders.get(name, [])
            # of several, the last one above the cell, as when the lesson is run from the top
            nearest = [i for i in binding if i < place][-1:] or binding[:1]
            demonstrations.update(nearest)
            bound |= _bound(cells, nearest)
            todo += [(i, names_of(cells[i].source).needed) for i in nearest]
    every = tuple(sorted(chosen | demonstrations))
    return Plan(every, why, tuple(sorted(demonstrations)), _cells_to_rerun(cells, exercise, every))


def _cells_to_rerun(
    cells: list[NotebookNode],
    exercise: Exercise,
    chosen: tuple[int, ...],
    *,
    names: Iterable[str] = (),
) -> tuple[int, ...]:
    """Return the cells that run the answer if a chosen cell below them binds a needed name.

    The first time, a constructor or a callback may have failed without that name.
    """
    if not exercise.run:
        return ()
    above = [i for i in chosen if i <= exercise.run[-1]]
    below = [i for i in chosen if i > exercise.run[-1]]
    there, lent = _bound(cells, above), _bound(cells, below)
    needed = names_of(cells[exercise.answer].source).needed
    _, met = _binding_cells(cells, chosen, {*names, *needed})
    if any(names_of(cells[i].source).binds_more for i in below):
        lent |= met  # it may bind one of them
    return exercise.run if met & lent - there else ()


def _binders(cells: list[NotebookNode], indexes: Iterable[int]) -> dict[str, list[int]]:
    """Return which cells bind each name; a table, as there may be 800 cells to search."""
    binders: dict[str, list[int]] = {}
    for i in indexes:
        for name in names_of(cells[i].source).bound:
            binders.setdefault(name, []).append(i)
    return binders


def _bound(cells: list[NotebookNode], indexes: Iterable[int]) -> set[str]:
    return set().union(*(names_of(cells[i].source).bound for i in indexes))


def _is_students(cell: NotebookNode) -> bool:
    return is_code(cell) and role(cell) in ('free', 'answer')


def _is_apart(cell: NotebookNode) -> bool:
    """Whether this cell of the lesson writes or runs a program, so that it binds no name."""
    return role(cell) in ('demo', 'setup') and cell.source.startswith(('%%bash', '%%write_node'))
