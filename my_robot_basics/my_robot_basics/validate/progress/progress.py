"""`./course progress`, and the list above the contents page: the exercises that passed."""

import argparse
import json
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Literal

from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.speaking import in_language, in_language_here, language_of, put
from my_robot_basics.session.arguments import Arguments
from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.lessons.cells import KEY
from my_robot_basics.validate.lessons.exercises import find_exercises
from my_robot_basics.validate.lessons.lesson import read_lesson
from my_robot_basics.validate.progress.passed_answers import (
    Pass,
    Passes,
    answer_of,
    default_path,
    read_passes,
)

State = Literal['passed', 'changed', 'open', 'by hand', 'at grading']
MARKS: dict[State, str] = {'passed': '✓', 'changed': '↻', 'open': '○'}
MARKS |= {'by hand': '…', 'at grading': '…'}
CONTENTS = 'contents'
"""The key, under KEY in the contents page's metadata, of its lessons and their exercises."""
TO_SHOW: tuple[str, ...] = ('Your progress', 'Passed in Validate: {passed} of {total} exercises.')
TO_SHOW += ('This is kept on this computer alone. You get your points at grading.',)
TO_SHOW += ('passed', 'changed since it passed: press Validate again', 'not passed yet')
TO_SHOW += ('a person reads it', 'checked only at grading')
WORDS: dict[State, str] = {
    'passed': 'passed',
    'changed': 'changed since it passed: press Validate again',
    'open': 'not passed yet',
    'by hand': 'a person reads it',
    'at grading': 'checked only at grading',
}


@dataclass(frozen=True)
class LessonProgress:
    """The current states of a lesson's exercises."""

    name: str
    title: str
    exercises: Mapping[str, State]


@dataclass(frozen=True)
class Progress:
    """All lessons of a contents page."""

    lessons: tuple[LessonProgress, ...]
    notes: tuple[str, ...] = ()
    """Sentences about files that could not be read."""
    language: str = ENGLISH

    @property
    def summary(self) -> str:
        """Return how many exercises passed, of those that Validate can check, as a sentence."""
        states = [state for lesson in self.lessons for state in lesson.exercises.values()]
        total = sum(state in ('passed', 'changed', 'open') for state in states)
        text = 'Passed in Validate: {passed} of {total} exercises.'
        return put(self.language, text, passed=states.count('passed'), total=total)

    def as_data(self) -> dict:
        """Return all of it, in its language, as JSON data."""
        say = partial(put, self.language)
        return {
            'title': say('Your progress'),
            'summary': self.summary,
            'about': say('This is kept on this computer alone. You get your points at grading.'),
            'notes': [in_language(self.language, note) for note in self.notes],
            'lessons': [
                {
                    'title': lesson.title,
                    'path': f'{lesson.name}/{lesson.name}.ipynb',
                    'exercises': [
                        {'name': name, 'state': state, 'mark': MARKS[state], 'words': say(word)}
                        for name, state in lesson.exercises.items()
                        for word in [WORDS[state]]
                    ],
                }
                for lesson in self.lessons
            ],
        }


def read_progress(page: Path, file: Path) -> Progress:
    """Return the progress in the lessons beside a contents page.

    Raises CourseError if `page` is not a contents page.
    """
    metadata = _metadata(page)
    notes: tuple[str, ...] = ()
    try:
        passes = read_passes(file)
    except CourseError as error:
        passes, notes = {}, (str(error),)
    lessons = tuple(_lessons(metadata, page, passes))
    return Progress(lessons, notes, language_of(metadata))


def _metadata(page: Path) -> Mapping:
    wrong = f'{page} is not the contents page of the course: name its index.ipynb'
    try:
        metadata = json.loads(page.read_bytes())['metadata']
        if isinstance(metadata[KEY][CONTENTS], list):
            return metadata
    except OSError as error:
        raise CourseError(f'{page} cannot be read: {error.strerror}') from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise CourseError(wrong) from None
    raise CourseError(wrong)


def _lessons(metadata: Mapping, page: Path, passes: Passes) -> Iterator[LessonProgress]:
    for row in metadata[KEY][CONTENTS]:
        match row:
            case {'lesson': str(name), 'title': str(title), 'exercises': list(exercises)}:
                kinds = {each['name']: each['checked'] for each in exercises}
                beside = page.parent / name / f'{name}.ipynb'
                states = _states(kinds, passes.get(name, {}), beside)
                yield LessonProgress(name, title, states)


def _states(
    kinds: Mapping[str, str], passes: Mapping[str, list[Pass]], beside: Path
) -> dict[str, State]:
    """Compare the passed answers with those now in the lesson, and in notebooks that passed."""
    places = {beside, *(Path(each.notebook) for found in passes.values() for each in found)}
    now = [answers for place in sorted(places) if (answers := _answers(place))] if passes else []
    states: dict[str, State] = {}
    for name, kind in kinds.items():
        passed = {each.answer for each in passes.get(name, ())}
        here = {answers[name] for answers in now if name in answers}
        if kind in ('by hand', 'at grading'):
            states[name] = 'by hand' if kind == 'by hand' else 'at grading'
        elif not passed:
            states[name] = 'open'
        else:
            states[name] = 'changed' if here and not here & passed else 'passed'
    return states


def _answers(notebook: Path) -> dict[str, str]:
    """Return the hash of each exercise's answer in a notebook; {} if it can't be read."""
    try:
        cells = read_lesson(notebook).notebook
        exercises = find_exercises(cells)
        return {each.name: answer_of(cells, each, notebook.parent) for each in exercises}
    except (CourseError, OSError):
        return {}


def main(arguments: list[str] | None = None) -> int:
    """Print the progress; return 0, or 2 if there is no contents page."""
    parser = Arguments(
        prog='./course progress',
        usage='./course progress [-h] [--language LANGUAGE]',
        description=in_language_here('Show which exercises Validate has seen pass.'),
    )
    parser.add_argument('page', type=Path, help=argparse.SUPPRESS)  # the launcher gives it
    try:
        progress = read_progress(parser.parse_args(arguments).page, default_path())
    except CourseError as error:
        print(f'progress: {in_language_here(str(error))}', file=sys.stderr)
        return 2
    told, say = progress.as_data(), partial(put, progress.language)
    print(told['summary'])
    for lesson in told['lessons']:
        print('', lesson['title'], sep='\n')
        for each in lesson['exercises']:
            line = say('{one} ({other})', one=each['name'], other=each['words'])
            print(f'  {each["mark"]} {line}')
    print('', *told['notes'], told['about'], sep='\n')
    return 0


if __name__ == '__main__':
    sys.exit(main())
