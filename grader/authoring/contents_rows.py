"""The rows of the contents page: what the first cell of a lesson or quiz says about it."""

import re
from collections.abc import Callable, Iterable
from functools import reduce

from my_robot_basics.feedback.hidden_source import without_hidden_part
from my_robot_basics.validate.lessons.cells import graded_id, role, title_of
from my_robot_basics.validate.lessons.exercises import find_exercises
from my_robot_basics.validate.lessons.titles import checks_something
from nbformat import NotebookNode

JOINED = '{abilities}; {ability}'
"""How the abilities of a lesson are joined."""


def row(path: str, lesson: NotebookNode, put: Callable[[str], str]) -> str:
    """Return the row of a notebook, with a link; `put` translates a text."""
    opening = lesson.cells[0].source
    exercises = ', '.join(f'`{name}`' for name in exercises_of(lesson))
    link = f'[{title_of(lesson)}]({path})'
    abilities = _joined(_abilities(opening), put(JOINED))
    points = f'{points_of(lesson):g}' if exercises else ''
    return '| ' + ' | '.join([link, abilities, *_needs(opening), exercises, points]) + ' |'


def minutes_of(lesson: NotebookNode) -> float:
    """Return how long a lesson takes, as its first cell says; 0 if it does not."""
    return float(_needs(lesson.cells[0].source)[1] or 0)


def points_of(lesson: NotebookNode) -> float:
    """Return the points of a lesson."""
    return sum(cell.metadata.get('nbgrader', {}).get('points', 0) for cell in lesson.cells)


def exercises_of(lesson: NotebookNode) -> list[str]:
    """Return the names of a lesson's exercises, in order."""
    checked = {exercise.name for exercise in find_exercises(lesson)}
    return [c_id for c in lesson.cells if (c_id := graded_id(c)) in checked or role(c) == 'answer']


def progress_row(name: str, lesson: NotebookNode) -> dict:
    """Return a lesson's row in the list of a student's progress: how each exercise is checked."""
    kinds = dict.fromkeys(exercises_of(lesson), 'by hand')
    for exercise in find_exercises(lesson):
        checks = [lesson.cells[i].source for i in exercise.grades]
        if checks:
            can_run = any(checks_something(without_hidden_part(check)) for check in checks)
            kinds[exercise.name] = 'here' if can_run else 'at grading'
    # a list, because nbformat sorts the keys of objects that it writes
    exercises = [{'name': each, 'checked': kind} for each, kind in kinds.items()]
    return {'lesson': name, 'title': title_of(lesson), 'exercises': exercises}


def join_sentences(sentences: Iterable[str]) -> str:
    """Join sentences to a paragraph: after a Chinese full stop there is no space."""
    return ' '.join(sentences).replace('。 ', '。')


def _joined(abilities: Iterable[str], pattern: str) -> str:
    return reduce(
        lambda before, ability: pattern.format(abilities=before, ability=ability),
        [*abilities] or [''],
    )


def _needs(opening: str) -> tuple[str, str]:
    """Return what a lesson requires, and its minutes, as its first cell says; or two blanks.

    It is the row of a table that ends with a number and words, '| about 35 minutes |', in any
    language.
    """
    found = re.search(r'^\| (.+) \| [^\d|\n]*(\d+)[^\d|\n]+ \|$', opening, re.M)
    return (found[1], found[2]) if found else ('', '')


def _abilities(opening: str) -> list[str]:
    """Return the items of a lesson's numbered list, each as one line for a table cell."""
    items = re.findall(r'^\d+\. (.+(?:\n[^\d\n|].*)*)', opening, re.MULTILINE)
    return [' '.join(item.split()).rstrip(',.;，。；').replace('|', r'\|') for item in items]
