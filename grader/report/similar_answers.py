"""Pairs of answers that are alike: a hint for a person, which never changes a score."""

from collections.abc import Iterable
from dataclasses import dataclass

import nbformat

from grader.common.parsing import Limits, ParsingFailed, parse
from grader.common.text import visible
from grader.course import Course
from grader.notebook.restore import grade_id

MOST_PAIRS = 10
"""How many pairs of one exercise are reported, the most similar ones."""
MOST_CHARACTERS = 20_000
"""A longer answer is not compared."""
LIMITS = Limits(cpu_sec=60)


@dataclass(frozen=True)
class SimilarPair:
    """Two answers to one exercise."""

    assignment: str
    exercise: str
    students: tuple[str, str]
    share: float
    """How much of the shorter answer is in the other one, from 0 to 1."""
    texts: tuple[str, str]
    """Both as HTML, with <mark> around what they have in common."""


@dataclass(frozen=True)
class SimilarAnswers:
    """The pairs that were found in some assignments."""

    pairs: tuple[SimilarPair, ...]
    problems: tuple[str, ...]
    """A sentence for each exercise whose answers could not be compared."""


def find_similar(course: Course, assignments: Iterable[str]) -> SimilarAnswers:
    """Compare the answers of all students whose submissions were graded."""
    pairs: list[SimilarPair] = []
    problems = []
    for assignment in assignments:
        for exercise, (released, answers) in _answers(course, assignment).items():
            try:
                found = parse(
                    'grader.report.fingerprints:find_pairs',
                    answers,
                    released,
                    MOST_PAIRS,
                    limits=LIMITS,
                )
            except ParsingFailed as why:
                problems.append(
                    f'{assignment}, {exercise}: answers were not compared, because {why}'
                )
                continue
            for each in found:
                one, other = each['students']
                left, right = each['texts']
                pairs.append(
                    SimilarPair(assignment, exercise, (one, other), each['share'], (left, right))
                )
    return SimilarAnswers(tuple(pairs), tuple(problems))


def _answers(course: Course, assignment: str) -> dict[str, tuple[str, dict[str, str]]]:
    """Return for each exercise the released text, and the students' answers."""
    # imported late: it takes long, and is not needed if nothing was graded
    from my_robot_basics.validate.lessons.exercises import find_exercises

    released = course.release(assignment)
    given = {
        exercise.name: released.cells[exercise.answer]
        for exercise in find_exercises(released)
        if released.cells[exercise.answer].cell_type == 'code'
    }
    answers: dict[str, dict[str, str]] = {name: {} for name in given}
    for path in course.folder('autograded', '', '').glob(f'*/{assignment}/{assignment}.ipynb'):
        for cell in nbformat.read(path, as_version=4).cells:
            if (name := grade_id(cell)) in given and len(cell.source) <= MOST_CHARACTERS:
                shown = visible(cell.source)
                if shown.strip() and len(shown) <= MOST_CHARACTERS:
                    answers[name][path.parts[-3]] = shown
    return {name: (given[name].source, answers[name]) for name in given if len(answers[name]) > 1}
