"""Refuse a lesson with an answer or a check outside of any exercise: it would not be graded."""

from collections.abc import Iterator

from my_robot_basics.validate.lessons.cells import grade_id, is_reset, role
from my_robot_basics.validate.lessons.exercises import find_exercises
from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode

from grader.common.errors import CourseError


class RequireExercises(Preprocessor):
    """Check that each check, and each answer that is graded by checks, is part of an exercise."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return everything unchanged. Raises CourseError with the cells and what to add."""
        if faults := [*outside_of_exercises(nb)]:
            raise CourseError('; '.join(faults))
        return nb, resources


def outside_of_exercises(notebook: NotebookNode) -> Iterator[str]:
    """Yield what to add for each answer without its reset cell, and each check without an answer.

    An exercise begins with its `<id>-reset` cell. Without it, a check would not be run, or would
    be run with the previous answer.
    """
    exercises = find_exercises(notebook)
    with_reset = {exercise.name for exercise in exercises}
    checked = {index for exercise in exercises for index in exercise.grades}
    last = None
    """The last answer cell; None after a reset cell."""
    for index, cell in enumerate(notebook.cells):
        name = grade_id(cell)
        if cell.cell_type != 'code':
            continue
        if is_reset(cell):
            last = None
        elif role(cell) == 'answer' and not cell.metadata.nbgrader.get('grade'):
            last = name
            if name not in with_reset:
                yield (
                    f'the answer cell `{name}` begins no exercise: put a Read-only cell with the'
                    f" id `{name}-reset` before it, which calls reset('NAME') with what the"
                    ' answer defines'
                )
        elif role(cell) == 'grade' and index not in checked and last is None:
            yield (
                f'the check `{name}` belongs to no exercise: put an answer cell before it, and'
                ' before that one a Read-only cell whose id is the same with `-reset` at its end'
            )
