"""Format a report for a terminal."""

from collections.abc import Iterator
from functools import partial

from my_robot_basics.language.lines import in_lines
from my_robot_basics.language.speaking import in_language, put
from my_robot_basics.validate.reports.report import MARKS, CheckFeedback, ExerciseFeedback, Report

COLUMNS = 100
MORE = {
    'at grading': 'checked only at grading',
    'by hand': 'a person reads it',
    'not checked': 'could not be checked',
}


def as_text(report: Report) -> str:
    """Return the report as lines of text."""
    lines = [report.notebook]
    for part in report.parts:
        lines += ['', *_part(part, report.language)]
    if report.notes:
        lines += ['', *(in_language(report.language, f'note: {note}') for note in report.notes)]
    return '\n'.join([*lines, '', report.summary])


def _part(part: ExerciseFeedback, language: str) -> Iterator[str]:
    yield part.name
    for trouble in part.troubles:
        yield from _indented(trouble)
    for check in part.checks:
        yield from _check(check, language)


def _check(check: CheckFeedback, language: str) -> Iterator[str]:
    say = partial(put, language)
    points = say(
        '{number} point' if check.points == 1 else '{number} points', number=f'{check.points:g}'
    )
    if check.outcome in ('failed', 'partial'):
        points = say('{earned} of {points}', earned=f'{check.earned:g}', points=points)
    more = MORE.get(check.outcome) or ('more checks at grading' if check.is_partly_hidden else '')
    about = say('({points}; {more})' if more else '({points})', points=points, more=say(more))
    gap = ' ' if about.isascii() else ''  # full-width brackets need no space before them
    yield f'  {MARKS[check.outcome]} {check.title}{gap}{about}'
    for line in (check.message, *check.notes):
        yield from _indented(line)


def _indented(line: str) -> list[str]:
    return in_lines(line, COLUMNS, first=' ' * 6, rest=' ' * 6)
