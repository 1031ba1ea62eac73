"""Read a student's notebook as a lesson: the role of each cell, and what was changed in it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
from nbformat import NotebookNode

from my_robot_basics.validate.errors import CourseError
from my_robot_basics.validate.lessons.cells import KEY, RELEASED, fingerprint, grade_id, roles


@dataclass(frozen=True)
class Lesson:
    """A notebook whose cells have their roles, one cell for each grade id."""

    notebook: NotebookNode
    hidden: dict[str, str]
    """By grade id: 'part' for a check with a hidden part, 'all' for one that is hidden."""
    altered: frozenset[str]
    """Grade ids of checks that are missing or differ from the released ones."""
    missing: dict[str, float]
    """Points of the graded cells that are missing, by grade id."""
    notes: tuple[str, ...]
    """Sentences about faults of the notebook, and what happens about them at grading."""


def read_lesson(path: Path) -> Lesson:
    """Read a notebook. Raises CourseError if that fails, or it has no exercise."""
    notebook = _read(path)
    notes: list[str] = []
    record = _record(notebook)
    numbers = {id(cell): number for number, cell in enumerate(notebook.cells, start=1)}
    for cell in notebook.cells:
        cell.metadata.pop(KEY, None)
        cell.source = cell.source.replace('\r\n', '\n')  # as the grader reads it
        _change_back(cell, notes)
        if cell.cell_type == 'code':
            cell.outputs, cell.execution_count = [], None
    notebook.cells = _one_for_each_id(notebook.cells, notes)
    for cell, given in zip(notebook.cells, roles(notebook), strict=True):
        number = numbers[id(cell)]
        cell.metadata[KEY] = {'role': _role(cell, given, record), 'number': number}
        if given == 'answer':
            cell.metadata[KEY][RELEASED] = record.get(grade_id(cell) or '', {}).get('source')
    graded = [c for c in notebook.cells if c.metadata[KEY].role in ('answer', 'grade')]
    if not graded:
        raise CourseError(f'{path} holds no exercise: name the notebook of a lesson')
    here = {name: cell for cell in notebook.cells if (name := grade_id(cell)) is not None}
    altered = _altered(here, record)
    return Lesson(
        notebook=notebook,
        hidden={name: mark['hidden'] for name, mark in record.items() if mark.get('hidden')},
        altered=frozenset(name for name in altered if record[name]['role'] == 'grade'),
        missing={name: record[name].get('points', 0) for name in altered if name not in here},
        notes=(*notes, *altered.values()),
    )


def _read(path: Path) -> NotebookNode:
    try:
        # an editor of Windows may have put a byte order mark before it
        return nbformat.reads(path.read_text(encoding='utf-8-sig'), as_version=4)
    except OSError as error:
        raise CourseError(
            f'{path} cannot be read: {error.strerror}; name the file of a notebook, '
            'such as notebooks/03_publisher/03_publisher.ipynb'
        ) from None
    except (nbformat.reader.NotJSONError, nbformat.ValidationError, ValueError) as error:
        why = str(error).splitlines()[0][:200]
        raise CourseError(
            f'{path} is not a notebook ({why}): save it in JupyterLab, or take a fresh copy'
        ) from None


def _record(notebook: NotebookNode) -> dict[str, dict[str, Any]]:
    """Return the released cells' roles and hashes by id; {} for a release without this record."""
    match notebook.metadata.get(KEY):
        case {'cells': dict(record)}:
            return {i: mark for i, mark in record.items() if {'role', 'source'} <= mark.keys()}
    return {}


def _change_back(cell: NotebookNode, notes: list[str]) -> None:
    """Change a cell of an exercise back to the cell type that it was released with."""
    wanted = cell.metadata.get('nbgrader', {}).get('cell_type', cell.cell_type)
    if wanted == cell.cell_type:
        return
    notes.append(f'the cell `{grade_id(cell)}` had another type: it is changed back')
    cell.cell_type = wanted
    if wanted == 'code':
        cell.pop('attachments', None)
        cell.outputs, cell.execution_count = [], None
    else:
        cell.pop('outputs', None)
        cell.pop('execution_count', None)


def _one_for_each_id(cells: list[NotebookNode], notes: list[str]) -> list[NotebookNode]:
    """Join an answer that was split into cells; of other cells with one id, keep the first."""
    first: dict[str, NotebookNode] = {}
    kept = []
    for cell in cells:
        name = grade_id(cell)
        if name is None or name not in first:
            kept.append(cell)
            if name is not None:
                first[name] = cell
        elif cell.metadata.nbgrader.get('solution'):
            notes.append(f'the answer cell `{name}` came in parts: they are joined')
            first[name].source += '\n\n' + cell.source
        else:
            notes.append(f'the cell `{name}` is there twice: only one counts')
    return kept


def _role(cell: NotebookNode, given: str, record: dict[str, dict[str, Any]]) -> str:
    """Return a cell's role; cells that students added or changed are 'free'."""
    if given in ('text', 'answer') or grade_id(cell) or not record:
        return given
    mark = record.get(cell.get('id', ''), {})
    return mark['role'] if mark.get('source') == fingerprint(cell.source) else 'free'


def _altered(here: dict[str, NotebookNode], record: dict[str, dict[str, Any]]) -> dict[str, str]:
    """Return a sentence for each cell of an exercise that was changed or deleted, by grade id."""
    said = {}
    for name, mark in record.items():
        if mark['role'] not in ('answer', 'grade', 'locked'):
            continue
        if name not in here:
            said[name] = f'the cell `{name}` is missing: it comes back at grading'
        elif mark['role'] != 'answer' and mark['source'] != fingerprint(here[name].source):
            said[name] = f'the cell `{name}` was changed: the original counts at grading'
    return said
