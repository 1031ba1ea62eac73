"""Find the exercises of a healed notebook: which of its cells are whose."""

from dataclasses import dataclass
from itertools import pairwise

from nbformat import NotebookNode

from my_robot_basics.validate.cells import grade_id, graded_id, is_code, is_reset, role
from my_robot_basics.validate.names import string_arguments
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


def find_exercises(notebook: NotebookNode) -> tuple[Exercise, ...]:
    """Return the exercises in the notebook's order; each begins with its `<id>-reset` cell.

    Where an answer cell was taken away there is no exercise.
    """
    starts = [i for i, cell in enumerate(notebook.cells) if is_reset(cell)]
    spans = [range(*span) for span in pairwise([*starts, len(notebook.cells)])]
    return tuple(
        _exercise(notebook, span, answer) for span in spans if (answer := _answer(notebook, span))
    )


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
        grades=tuple(i for i in span if role(cells[i]) == 'grade' and is_code(cells[i])),
        packages=tuple(name for i in span for name in packages_built_by(cells[i])),
    )
