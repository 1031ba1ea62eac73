"""Rebuild a submitted notebook from its source: only the answers are taken from the student."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

import nbformat
from my_robot_basics.language.catalogues import ENGLISH
from my_robot_basics.language.speaking import LANGUAGE, language_of
from my_robot_basics.validate.lessons.cells import (
    KEY,
    RELEASED,
    fingerprint,
    grade_id,
    role,
    roles,
    title_of,
)
from nbformat import NotebookNode

NO_ANSWERS = (
    'the notebook holds none of the answer cells of this assignment: it is another notebook, they '
    "were deleted, or a program has removed nbgrader's metadata from them. Write your answers "
    'into the notebook of this lesson that you were given, save it in JupyterLab, and submit that '
    'file'
)


@dataclass(frozen=True)
class AssignmentTemplate:
    """What all submissions of an assignment are restored from."""

    notebook: NotebookNode
    """The instructor's cells with hidden tests, but with the released stubs as answers."""
    released: dict[str, str]
    """The source of each cell that students were given, by grade id."""


@dataclass(frozen=True)
class RestoredNotebook:
    """A notebook with every cell of its source, in the source's order, and notes on changes."""

    notebook: NotebookNode
    notes: tuple[str, ...]


@dataclass
class _Found:
    """What a submission has for one cell of the source."""

    parts: list[NotebookNode] = field(default_factory=list)
    after: list[NotebookNode] = field(default_factory=list)
    """The student's own cells that follow it."""


def make_template(source: NotebookNode, release: NotebookNode) -> AssignmentTemplate:
    """Combine the instructor's notebook with the one that students were given."""
    released = {name: cell.source for cell in release.cells if (name := grade_id(cell))}
    notebook = nbformat.from_dict(source)
    for cell, kind in zip(notebook.cells, roles(notebook), strict=True):
        cell.metadata[KEY] = {'role': kind}
        if kind == 'answer':
            cell.source = released.get(grade_id(cell) or '', '')
            cell.metadata[KEY][RELEASED] = fingerprint(cell.source)
        if cell.cell_type == 'code':
            cell.outputs, cell.execution_count = [], None
    return AssignmentTemplate(notebook=notebook, released=released)


def restore(submitted: NotebookNode, template: AssignmentTemplate) -> RestoredNotebook:
    """Build the notebook that is graded: the template's cells with the student's answers.

    Locked and grade cells come from the template, even if the student changed them. If an answer
    was split or repeated, all its parts are kept. A cell that the student added stays after the
    cell that it followed. Every change to a locked, grade or answer cell is noted.
    """
    notes: list[str] = []
    found = _match(submitted, template.notebook)
    cells = [_from_student(cell) for cell in found[-1].after]
    for index, cell in enumerate(template.notebook.cells):
        cells.extend(_restore(cell, found[index].parts, template.released, notes))
        cells.extend(_from_student(own) for own in found[index].after)
    _give_unique_ids(cells)
    answers = [i for i, cell in enumerate(template.notebook.cells) if role(cell) == 'answer']
    if answers and not any(found[i].parts for i in answers):
        notes = [NO_ANSWERS, *notes]
    restored = nbformat.v4.new_notebook(cells=cells)
    restored.metadata = nbformat.from_dict(template.notebook.metadata)
    restored.metadata[KEY] = {'notes': notes, 'title': title_of(template.notebook)}
    if (language := language_of(submitted.metadata)) != ENGLISH:
        restored.metadata[KEY][LANGUAGE] = language  # for feedback; grading ignores it
    return RestoredNotebook(notebook=restored, notes=tuple(notes))


def _match(submitted: NotebookNode, template: NotebookNode) -> dict[int, _Found]:
    """Find each submitted cell's index in the template, by grade id, else by text or cell id."""
    by_grade_id = {grade_id(c): i for i, c in enumerate(template.cells) if grade_id(c)}
    plain = [(i, c) for i, c in enumerate(template.cells) if not grade_id(c)]
    by_id = {c.id: i for i, c in plain if 'id' in c}
    by_text = {(c.cell_type, c.source): i for i, c in plain}
    found: dict[int, _Found] = defaultdict(_Found)
    place = -1
    for cell in submitted.cells:
        index = by_grade_id.get(grade_id(cell))
        if index is None:
            index = by_text.get((cell.cell_type, cell.source), by_id.get(cell.get('id')))
            if index is None or found[index].parts:
                if cell.source.strip():
                    found[place].after.append(cell)
                continue
        place = index
        found[index].parts.append(cell)
    return found


def _restore(
    cell: NotebookNode, parts: list[NotebookNode], released: dict[str, str], notes: list[str]
) -> Iterator[NotebookNode]:
    """Yield the restored cells for one cell of the template."""
    kind, name = role(cell), grade_id(cell)
    original = nbformat.from_dict(cell)
    changed = bool(parts) and parts[0].source not in (cell.source, released.get(name or ''))
    if changed and kind in ('demo', 'free'):
        yield _from_student(parts[0])
        return
    if kind == 'answer':
        _answer(original, parts, notes)
    yield original
    if kind in ('grade', 'locked'):
        if not parts:
            notes.append(f'the cell `{name}` was missing: it was put back')
        elif len(parts) > 1:
            notes.append(f'the cell `{name}` was there {len(parts)} times: the original counts')
        elif changed or parts[0].cell_type != cell.cell_type:
            notes.append(
                f"the cell `{name}` was changed, or is of an earlier release: the lesson's counts"
            )
    elif kind == 'setup' and changed:
        yield _from_student(parts[0])  # an answer may need what it defines


def _answer(cell: NotebookNode, parts: list[NotebookNode], notes: list[str]) -> None:
    """Put the student's text into an answer cell."""
    name = grade_id(cell)
    # beside an answer, an unchanged copy of the stub was left over: it would overwrite the answer
    written = [part for part in parts if part.source.strip() not in ('', cell.source.strip())]
    parts = written or parts[:1]
    if not parts:
        notes.append(f'the answer cell `{name}` was missing: it was put back, without an answer')
        return
    if len(parts) > 1:
        notes.append(f'the answer cell `{name}` came in {len(parts)} parts: they were joined')
    if any(part.cell_type != cell.cell_type for part in parts):
        notes.append(f'the answer cell `{name}` had another type: it was changed back')
    cell.source = '\n\n'.join(dict.fromkeys(part.source for part in parts))
    pictures = {k: v for part in parts for k, v in part.get('attachments', {}).items()}
    if pictures and cell.cell_type == 'markdown':
        cell.attachments = nbformat.from_dict(pictures)


def _from_student(cell: NotebookNode) -> NotebookNode:
    """Copy a cell that the student added, without any metadata of the student's."""
    own = nbformat.from_dict(cell)
    own.metadata = nbformat.from_dict({KEY: {'role': 'text'}})
    if own.cell_type == 'code':
        own.metadata[KEY].role = 'free'
        own.outputs, own.execution_count = [], None
    return own


def _give_unique_ids(cells: list[NotebookNode]) -> None:
    seen: set[str] = set()
    for cell in cells:
        if cell.get('id') in seen | {None}:
            cell.id = nbformat.v4.new_code_cell().id
        seen.add(cell.id)
