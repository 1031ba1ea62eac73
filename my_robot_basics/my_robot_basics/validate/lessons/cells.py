"""The role of a lesson's cell, from its metadata."""

import hashlib

from nbformat import NotebookNode

KEY = 'my_robot_basics'
"""The course's only key in a cell's metadata: {'role': ...}, and after grading the verdict."""
RECORD = 'cells'
"""The key, under KEY in a released notebook's metadata, of each cell's role and source hash when
it was released, by its nbgrader id, or else by its own id."""
RELEASED = 'released'
"""The key, under KEY in an answer cell's metadata, of its source hash when it was released."""


def grade_id(cell: NotebookNode) -> str | None:
    """Return the cell's nbgrader id, if it has one."""
    return cell.metadata.get('nbgrader', {}).get('grade_id')


def graded_id(cell: NotebookNode) -> str:
    """Return the id of a cell that nbgrader knows."""
    return grade_id(cell) or ''


def role(cell: NotebookNode) -> str:
    """Return a cell's role: answer, grade, locked, setup, demo, free or text."""
    if recorded := cell.metadata.get(KEY, {}).get('role'):
        return recorded
    marks = cell.metadata.get('nbgrader', {})
    if marks.get('solution'):
        return 'answer'
    if marks.get('grade'):
        return 'grade'
    if cell.cell_type != 'code':
        return 'text'
    if marks.get('locked'):
        return 'locked'
    return 'demo' if 'demo' in cell.metadata.get('tags', ()) else 'setup'


def is_code(cell: NotebookNode) -> bool:
    """Whether it is a code cell."""
    return cell.cell_type == 'code'


def is_reset(cell: NotebookNode) -> bool:
    """Whether the cell begins an exercise: it deletes names and nodes of earlier cells."""
    return (grade_id(cell) or '').endswith('-reset')


def title_of(notebook: NotebookNode) -> str:
    """Return a lesson's title: its first heading of level 1, or ''."""
    texts = (cell.source for cell in notebook.cells if cell.cell_type == 'markdown')
    heads = (line for text in texts for line in text.splitlines() if line.startswith('# '))
    return next(heads, '').removeprefix('# ').strip()


def roles(notebook: NotebookNode) -> list[str]:
    """Return the role of each cell of a lesson as its author wrote it."""
    found, in_exercise = [], False
    for cell in notebook.cells:
        kind = role(cell)
        in_exercise = is_reset(cell) or (in_exercise and kind != 'grade')
        # a code cell of an exercise that is neither marked nor a demo is its "try it" cell
        found.append('free' if kind == 'setup' and in_exercise else kind)
    return found


def fingerprint(source: str) -> str:
    """Return a short hash that identifies a cell's source."""
    return hashlib.sha256(source.strip().encode(errors='replace')).hexdigest()[:12]
