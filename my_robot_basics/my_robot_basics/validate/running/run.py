"""Validate a lesson: run only the cells that its exercises need, and report the results."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from nbformat import NotebookNode

from my_robot_basics.language.speaking import in_language, language_of, put
from my_robot_basics.validate.kernels.forks import ForkServer
from my_robot_basics.validate.lessons.cell_names import replace_cell_ids
from my_robot_basics.validate.lessons.cells import grade_id, graded_id, role
from my_robot_basics.validate.lessons.exercises import Exercise, find_exercises
from my_robot_basics.validate.lessons.lesson import Lesson, read_lesson
from my_robot_basics.validate.progress.passed_answers import answer_of
from my_robot_basics.validate.reports.check_feedback import make_check, troubles_of
from my_robot_basics.validate.reports.report import CheckFeedback, ExerciseFeedback, Report
from my_robot_basics.validate.running.rooms import LocalRooms, Say
from my_robot_basics.validate.running.short_budget import ShortBudget
from my_robot_basics.validate.together import gather_or_cancel
from my_robot_basics.validate.verdicts.judging import JudgedExercise, judge_exercise
from my_robot_basics.validate.verdicts.side_by_side import join_judged, split_exercise

SIDE_BY_SIDE = 2
"""How many exercises, or parts of them, run at a time: most of their time is waiting, except in
endless loops."""


async def validate(
    path: Path,
    server: ForkServer,
    *,
    say: Say = lambda line: None,
    speak: Callable[[str], None] = lambda language: None,
    tell: Callable[[Report], None] = lambda report: None,
) -> Report:
    """Run the visible checks of a notebook, each exercise in fresh kernels of a server.

    `speak` is called with the notebook's language, `say` with a line in it for each step, and
    `tell` with the report, before all kernels have ended. Raises CourseError if the file is not
    a notebook of the course.
    """
    lesson = read_lesson(path)
    language = language_of(lesson.notebook.metadata)
    speak(language)
    files = [p for p in sorted(path.parent.glob('*.py')) if p.is_file()]
    make_rooms = partial(LocalRooms, files=files, server=server, beside=path.parent)
    run = _Run(lesson, path.parent, make_rooms, say, language)
    parts = await gather_or_cancel(*map(run.part, find_exercises(lesson.notebook)))
    named = {check.name for part in parts for check in part.checks}
    parts += [*_by_hand(lesson), *_without_exercise(lesson, named), *_missing(lesson)]
    report = Report(path.name, tuple(parts), lesson.notes, language)
    report = report.with_words(
        lambda text: replace_cell_ids(text, lesson.notebook, language),
        title=partial(in_language, language),
    )
    tell(report)
    await asyncio.gather(*run.ends)
    return report


@dataclass(frozen=True)
class _Run:
    """What the exercises of one lesson share."""

    lesson: Lesson
    folder: Path
    make_rooms: Callable[[], LocalRooms]
    say: Say
    language: str
    places: asyncio.Semaphore = field(default_factory=lambda: asyncio.Semaphore(SIDE_BY_SIDE))
    budget: ShortBudget = field(default_factory=ShortBudget)
    ends: list[asyncio.Task] = field(default_factory=list)
    """Tasks that end kernels which are no longer needed."""

    async def part(self, exercise: Exercise) -> ExerciseFeedback:
        """Judge an exercise by the checks that can be run, as soon as places are free."""
        runnable = tuple(i for i in exercise.grades if _can_run(self.lesson, i))
        parts = split_exercise(self.lesson.notebook, replace(exercise, grades=runnable))
        done = await gather_or_cancel(
            *(self._judge(exercise, part) for part in parts if part.grades)
        )
        answers = {answer for answer, _ in done}
        judged = _part(self.lesson, exercise, join_judged([each for _, each in done]))
        return replace(judged, answer=answers.pop() if len(answers) == 1 else '')

    async def _judge(self, exercise: Exercise, part: Exercise) -> tuple[str, JudgedExercise]:
        """Wait for a free place, then judge a part of an exercise; return the answer, too."""
        async with self.places:
            # before the checks: a package may be edited while they run
            answer = answer_of(self.lesson.notebook, exercise, self.folder)
            rooms = partial(self._rooms, exercise)
            return answer, await judge_exercise(self.lesson.notebook, part, rooms, self.budget)

    def _rooms(self, exercise: Exercise) -> LocalRooms:
        rooms = self.make_rooms()
        rooms.say = partial(_say_of, exercise.name, self.say, self.language)
        rooms.end_later = lambda end: self.ends.append(asyncio.create_task(end))
        return rooms


def _say_of(exercise: str, say: Say, language: str, line: str) -> None:
    say(put(language, '{one}: {other}', one=exercise, other=in_language(language, line)))


def _can_run(lesson: Lesson, index: int) -> bool:
    name = graded_id(lesson.notebook.cells[index])
    return name not in lesson.altered and lesson.hidden.get(name) != 'all'


def _part(lesson: Lesson, exercise: Exercise, judged: JudgedExercise) -> ExerciseFeedback:
    checks = []
    for index in exercise.grades:
        verdict, outputs = judged.checks.get(index, (None, []))
        checks.append(make_check(lesson, lesson.notebook.cells[index], verdict, outputs))
    verdicts = [verdict for verdict, _ in judged.checks.values()]
    return ExerciseFeedback(exercise.name, troubles_of(verdicts), tuple(checks))


def _by_hand(lesson: Lesson) -> list[ExerciseFeedback]:
    """Return the entries of answers that a person reads."""
    written = [c for c in lesson.notebook.cells if role(c) == 'answer' and _has_points(c)]
    checks: list[CheckFeedback] = [make_check(lesson, cell, None, []) for cell in written]
    return [ExerciseFeedback(check.name, (), (check,)) for check in checks]


def _without_exercise(lesson: Lesson, named: set[str]) -> list[ExerciseFeedback]:
    """Return the entries of checks whose answer cell or reset cell was deleted."""
    cells = [c for c in lesson.notebook.cells if role(c) == 'grade' and grade_id(c) not in named]
    checks = [make_check(lesson, cell, None, []) for cell in cells]
    return [ExerciseFeedback(check.name, (), (check,)) for check in checks]


def _missing(lesson: Lesson) -> list[ExerciseFeedback]:
    checks = [
        CheckFeedback(name, name, points, 'not checked', is_partly_hidden=False)
        for name, points in lesson.missing.items()
        if points
    ]
    return [ExerciseFeedback(check.name, (), (check,)) for check in checks]


def _has_points(cell: NotebookNode) -> bool:
    return bool(cell.metadata.nbgrader.get('grade'))
