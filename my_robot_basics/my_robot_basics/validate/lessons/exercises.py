"""Find the exercises of a notebook, and the cells of each; the notebook is restored before."""

from dataclasses import dataclass
from itertools import pairwise

from nbformat import NotebookNode

from my_robot_basics.validate.lessons.cells import grade_id, graded_id, is_code, is_reset, role
from my_robot_basics.validate.lessons.names import string_arguments
from my_robot_basics.validate.lessons.packages import packages_built_by


@dataclass(frozen=True)
class Exercise:
    """One exercise: positions of its cells in the notebook."""

    name: str
    """The grade id of its answer cell."""
    defines: tuple[str, ...]
    """The names that the answer has to define, which its reset cell deletes."""
    reset: int
    answer: int
    run: tuple[int, ...]
    """Locked cells that run the answer."""
    grades: tuple[int, ...]
    packages: tuple[str, ...] = ()
    """ROS packages that its locked cells build: then their folders are the answer."""


def find_exercises(notebook: NotebookNode) -> tuple[Exercise, ...]:
    """Return the exercises in the notebook's order; each begins with its `<id>-reset` cell.

    An exercise whose answer cell was deleted is left out.
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
