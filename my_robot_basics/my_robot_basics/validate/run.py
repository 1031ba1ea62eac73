"""Validate a lesson: run what its exercises need, nothing else, and say what came of it."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from nbformat import NotebookNode

from my_robot_basics.validate.ahead import Ahead
from my_robot_basics.validate.cell_names import in_words
from my_robot_basics.validate.cells import grade_id, graded_id, role
from my_robot_basics.validate.exercises import Exercise, find_exercises
from my_robot_basics.validate.judging import Judged, judge_exercise
from my_robot_basics.validate.lesson import Lesson, read_lesson
from my_robot_basics.validate.report import Check, Part, Report, make_check, troubles_of
from my_robot_basics.validate.short_budget import ShortBudget

Say = Callable[[str], None]


async def validate(path: Path, *, say: Say = lambda line: None) -> Report:
    """Run the visible checks of a notebook, each exercise in fresh kernels.

    `say` gets a line whenever something else begins. Raises CourseError where the file is no
    notebook of the course.
    """
    lesson = read_lesson(path)
    files = [p for p in sorted(path.parent.glob('*.py')) if p.is_file()]
    budget = ShortBudget()
    parts = []
    exercises = find_exercises(lesson.notebook)
    async with Ahead(files) as ahead:
        for number, exercise in enumerate(exercises, start=1):
            open_rooms = partial(
                ahead.rooms,
                say=partial(_say_of, exercise.name, say),
                more=number < len(exercises),
            )
            judged = Judged({}, {})
            if runnable := tuple(i for i in exercise.grades if _can_run(lesson, i)):
                judged = await judge_exercise(
                    lesson.notebook, replace(exercise, grades=runnable), open_rooms, budget
                )
            parts.append(_part(lesson, exercise, judged))
    told = {check.name for part in parts for check in part.checks}
    parts += [*_by_hand(lesson), *_without_exercise(lesson, told), *_missing(lesson)]
    report = Report(path.name, tuple(parts), lesson.notes)
    return report.with_words(lambda text: in_words(text, lesson.notebook))


def _say_of(exercise: str, say: Say, line: str) -> None:
    say(f'{exercise}: {line}')


def _can_run(lesson: Lesson, index: int) -> bool:
    name = graded_id(lesson.notebook.cells[index])
    return name not in lesson.altered and lesson.hidden.get(name) != 'all'


def _part(lesson: Lesson, exercise: Exercise, judged: Judged) -> Part:
    checks = []
    for index in exercise.grades:
        verdict, outputs = judged.checks.get(index, (None, []))
        checks.append(make_check(lesson, lesson.notebook.cells[index], verdict, outputs))
    verdicts = [verdict for verdict, _ in judged.checks.values()]
    return Part(exercise.name, troubles_of(verdicts), tuple(checks))


def _by_hand(lesson: Lesson) -> list[Part]:
    """Tell of the answers that a person reads."""
    written = [c for c in lesson.notebook.cells if role(c) == 'answer' and _has_points(c)]
    checks: list[Check] = [make_check(lesson, cell, None, []) for cell in written]
    return [Part(check.name, (), (check,)) for check in checks]


def _without_exercise(lesson: Lesson, told: set[str]) -> list[Part]:
    """Tell of the checks whose answer cell, or what begins their exercise, was taken away."""
    cells = [c for c in lesson.notebook.cells if role(c) == 'grade' and grade_id(c) not in told]
    checks = [make_check(lesson, cell, None, []) for cell in cells]
    return [Part(check.name, (), (check,)) for check in checks]


def _missing(lesson: Lesson) -> list[Part]:
    checks = [
        Check(name, name, points, 'not checked', is_partly_hidden=False)
        for name, points in lesson.missing.items()
        if points
    ]
    return [Part(check.name, (), (check,)) for check in checks]


def _has_points(cell: NotebookNode) -> bool:
    return bool(cell.metadata.nbgrader.get('grade'))
