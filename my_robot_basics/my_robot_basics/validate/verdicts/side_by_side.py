"""Parts of an exercise that can be judged at the same time, each in rooms of its own."""

from collections.abc import Sequence
from dataclasses import replace

from nbformat import NotebookNode

from my_robot_basics.validate.lessons.exercises import Exercise
from my_robot_basics.validate.lessons.names import names_of
from my_robot_basics.validate.verdicts.judging import JudgedExercise


def split_exercise(notebook: NotebookNode, exercise: Exercise) -> tuple[Exercise, ...]:
    """Return an exercise with packages as two: all its checks but the last, and the last one.

    Its checks start processes of their own and mostly wait for them, so that half the time is
    worth a second build. Another exercise is returned as it is, and so is one whose last check
    reads, or may read, a name that an earlier check binds.
    """
    if not exercise.packages or len(exercise.grades) < 2:
        return (exercise,)
    *first, last = exercise.grades
    earlier = [names_of(notebook.cells[index].source) for index in first]
    bound = set().union(*(names.bound for names in earlier))
    own = names_of(notebook.cells[last].source)
    is_open = own.needs_more or any(names.binds_more for names in earlier)
    if is_open or not own.needed.isdisjoint(bound):
        return (exercise,)
    return replace(exercise, grades=tuple(first)), replace(exercise, grades=(last,))


def join_judged(parts: Sequence[JudgedExercise]) -> JudgedExercise:
    """Return the results of an exercise's parts as those of one; a cell's first run counts."""
    runs = {index: run for part in reversed(parts) for index, run in part.runs.items()}
    checks = {index: check for part in parts for index, check in part.checks.items()}
    return JudgedExercise(runs, checks)
