"""Check that the BEGIN and END lines of nbgrader's regions come in pairs, and in the right cells.

nbgrader refuses such a lesson, too, but does not name the cell, and it ignores an END without
its BEGIN. It takes a misspelt pair for comments: students would get what is between them.
"""

import difflib
from collections.abc import Iterator
from dataclasses import dataclass

from my_robot_basics.validate.lessons.cells import grade_id
from nbformat import NotebookNode


@dataclass(frozen=True)
class _Region:
    """A kind of region that students must not see."""

    words: str
    last: str
    """How a message to the author names its last line."""
    kind: str = ''
    """The key of nbgrader's metadata that a cell needs to have such a region; '' for any cell."""
    type_there: str = ''
    """The type of such a cell in *Create Assignment*; '' for any cell."""


REGIONS = (
    _Region('SOLUTION', "the answer's last line", 'solution', 'Autograded answer'),
    _Region('HIDDEN TESTS', 'the last hidden line', 'grade', 'Autograded tests'),
    _Region('MARK SCHEME', 'its last line'),
)
MARKS = [f'{edge} {region.words}' for region in REGIONS for edge in ('BEGIN', 'END')]
ALIKE = 0.75
"""From this similarity on, a comment is a misspelt mark: BEGIN TESTS, End solution."""


def marker_faults(notebook: NotebookNode) -> Iterator[str]:
    """Yield which cell has a region without its end or its beginning, and what to add."""
    for cell in notebook.cells:
        name = grade_id(cell) or cell.get('id', 'without an id')
        for fault in _misspelt(cell):
            yield f'the cell `{name}`, {fault}'
        for region in REGIONS:
            for fault in _faults(cell, region):
                yield f'the cell `{name}`, {fault}'


def _faults(cell: NotebookNode, region: _Region) -> Iterator[str]:
    begin, end = f'BEGIN {region.words}', f'END {region.words}'
    opened = 0
    """The line, from 1, where a region begins that has not ended yet; 0 if there is none."""
    for number, line in enumerate(cell.source.split('\n'), 1):
        if begin in line:
            if opened:
                yield _without_end(region, opened, f'before line {number}, where another begins')
            opened = number
            if region.kind and not cell.metadata.get('nbgrader', {}).get(region.kind):
                yield (
                    f'line {number}: {begin!r} is in a cell of another type: give the cell'
                    f' the type {region.type_there!r} in Create Assignment, or remove the line'
                )
        elif end in line:
            if not opened:
                yield (
                    f'line {number}: {end!r} ends nothing: add a line {"### " + begin!r} before'
                    ' what students must not see, or remove this one'
                )
            opened = 0
    if opened:
        yield _without_end(region, opened, f'after {region.last}')


def _misspelt(cell: NotebookNode) -> Iterator[str]:
    for number, line in enumerate(cell.source.split('\n'), 1):
        words = line.strip().lstrip('#').strip()
        if not line.strip().startswith('#') or any(mark in line for mark in MARKS):
            continue
        for mark in difflib.get_close_matches(words.upper(), MARKS, 1, ALIKE):
            yield f'line {number}: {words!r} marks nothing: write {"### " + mark!r}'


def _without_end(region: _Region, opened: int, where: str) -> str:
    end = f'### END {region.words}'
    return f"line {opened}: 'BEGIN {region.words}' has no end: add a line {end!r} {where}"
