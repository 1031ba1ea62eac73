"""Check that the graded cells of a lesson have the metadata that nbgrader needs.

nbgrader refuses such a lesson, too, but only says that metadata may be corrupted, not where.
"""

import ast
import re
from collections.abc import Iterator

from my_robot_basics.validate.lessons.cells import role
from my_robot_basics.validate.lessons.names import names_of
from nbformat import NotebookNode

SCHEMA = 3
"""The schema version of the metadata that nbgrader 0.9 reads and writes."""
_ID = re.compile(r'[a-zA-Z0-9_\-]+')
_TYPES = ('grade', 'solution', 'locked', 'task')
"""Keys of which each true one gives a cell a type in Create Assignment."""
_NEEDED = ('grade', 'solution', 'locked')
"""Keys that nbgrader reads from its metadata of each cell, even if the cell has no type."""


def metadata_faults(notebook: NotebookNode) -> Iterator[str]:
    """Yield what is wrong with each cell that has nbgrader metadata, and what to do."""
    ids = set()
    lent: set[str] = set()
    """What the checks above bind: those of an exercise share a process."""
    unclear = False
    """Whether one of them may bind names that its text does not show, by a star import."""
    for number, cell in enumerate(notebook.cells, 1):
        if 'nbgrader' not in cell.metadata:
            continue
        marks = cell.metadata.nbgrader
        name = str(marks.get('grade_id') or '')
        shown = f'the cell `{name}`' if name else f'cell {number} of the notebook'
        if marks.get('schema_version') != SCHEMA:
            yield (
                f'{shown} is of another version of nbgrader:'
                ' .venv/bin/nbgrader update solutions brings it up to date'
            )
        elif lacking := [each for each in _NEEDED if each not in marks]:
            yield f'{shown} lacks {lacking[0]!r}: choose its type again in Create Assignment'
        if not any(marks.get(each) for each in _TYPES):
            continue
        if not _ID.fullmatch(name) or name != marks.get('grade_id'):
            yield (
                f'{shown} needs an ID in Create Assignment: letters, digits, - and _,'
                ' which no other cell has'
            )
        elif name in ids:
            yield (
                f'two cells have the ID `{name}`: give the second one another in Create Assignment'
            )
        ids.add(name)
        for fault in _faults(cell):
            yield f'{shown} {fault}'
        if cell.cell_type == 'code' and role(cell) == 'grade':
            names = names_of(cell.source)
            unclear |= names.binds_more
            if not unclear and (unbound := sorted(names.needed - lent)):
                yield (
                    f'{shown} uses {unbound[0]!r}, which it does not bind: a check runs apart'
                    ' from the lesson, so import or define it in the check'
                )
            lent |= names.bound


def _faults(cell: NotebookNode) -> Iterator[str]:
    marks = cell.metadata.nbgrader
    points = marks.get('points')
    if (marks.get('grade') or marks.get('task')) and not _counts(points):
        has = 'no' if points is None else repr(points)
        yield f'has {has} points: write a number from 0 on into Points in Create Assignment'
    if marks.get('task') and cell.cell_type != 'markdown':
        yield 'is a task in a code cell: make it a markdown cell, or choose another type for it'
    if cell.cell_type == 'markdown' and not marks.get('task'):
        if marks.get('grade') and not marks.get('solution'):
            yield (
                'is a check in a markdown cell: make it a code cell, or give it the type'
                " 'Manually graded answer' in Create Assignment"
            )
        elif marks.get('solution') and not marks.get('grade'):
            yield (
                'is an answer in words, which no check can grade: give it the type'
                " 'Manually graded answer' in Create Assignment, with points"
            )
    if cell.cell_type == 'code' and role(cell) == 'grade':
        try:
            ast.parse(cell.source)
        except SyntaxError as error:
            why = f'line {error.lineno}: {error.msg}'
            yield f'is a check that is not valid Python: {why}; correct it'


def _counts(points: object) -> bool:
    return not isinstance(points, bool) and isinstance(points, int | float) and points >= 0
