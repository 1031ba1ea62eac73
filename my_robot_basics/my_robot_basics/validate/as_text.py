"""Lay a report out for a terminal."""

import textwrap
from collections.abc import Iterator

from my_robot_basics.validate.report import MARKS, CheckFeedback, ExerciseFeedback, Report

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
        lines += ['', *_part(part)]
    if report.notes:
        lines += ['', *(f'note: {note}' for note in report.notes)]
    return '\n'.join([*lines, '', report.summary])


def _part(part: ExerciseFeedback) -> Iterator[str]:
    yield part.name
    for trouble in part.troubles:
        yield from _indented(trouble)
    for check in part.checks:
        yield from _check(check)


def _check(check: CheckFeedback) -> Iterator[str]:
    lost = f'{check.earned:g} of ' if check.outcome in ('failed', 'partial') else ''
    points = f'{lost}{check.points:g} point{"" if check.points == 1 else "s"}'
    more = MORE.get(check.outcome) or ('more checks at grading' if check.is_partly_hidden else '')
    about = f'({points}{"; " if more else ""}{more})'
    yield f'  {MARKS[check.outcome]} {check.title} {about}'
    for line in (check.message, *check.notes):
        yield from _indented(line)


def _indented(line: str) -> list[str]:
    return textwrap.wrap(
        line, COLUMNS, initial_indent=' ' * 6, subsequent_indent=' ' * 6, break_on_hyphens=False
    )
