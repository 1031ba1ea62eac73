"""Put the sample class back onto the lessons as they are released today.

    .venv/bin/python tests/submissions/rebase.py

Each sample keeps its answers and its own cells; all else comes from notebooks/. A sample whose
point is a damaged notebook is damaged again.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import nbformat
from nbformat import NotebookNode

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from grader.course import Course
from grader.heal import KEY, grade_id, heal, make_master

FOLDER = Path(__file__).parent


def samples() -> list[Path]:
    """Return every notebook of the sample class."""
    return sorted(FOLDER.glob('*.ipynb'))


def assignment_of(sample: Path) -> str:
    """Return the assignment that a sample is named after: `<assignment>-<outcome>-<why>`."""
    return sample.stem.split('-', maxsplit=1)[0]


def rebased(name: str, sample: NotebookNode) -> str:
    """Return the text of a sample's file on today's release."""
    release = Course().release(name.split('-', maxsplit=1)[0])
    notebook = heal(sample, make_master(release, release)).notebook
    notebook.metadata.pop(KEY)
    for index, cell in enumerate(notebook.cells):
        own = cell.metadata.pop(KEY).role in ('free', 'text')
        if own and cell.id not in {known.get('id') for known in release.cells}:
            cell.id = f'own-{index}'
    DAMAGE.get(name, lambda notebook: None)(notebook)
    return nbformat.writes(notebook) + '\n'


def _grade_cells(notebook: NotebookNode) -> list[NotebookNode]:
    return [c for c in notebook.cells if c.metadata.get('nbgrader', {}).get('grade')]


def _delete_locked_and_grade_cells(notebook: NotebookNode) -> None:
    notebook.cells = [
        cell for cell in notebook.cells if not cell.metadata.get('nbgrader', {}).get('locked')
    ]


def _repeat_and_shuffle(notebook: NotebookNode) -> None:
    repeated = [nbformat.from_dict(cell) for cell in _grade_cells(notebook)]
    for cell in repeated:
        cell.id += '-again'
    notebook.cells = [*reversed(repeated), *notebook.cells]


def _let_grade_cells_pass(notebook: NotebookNode) -> None:
    for cell in _grade_cells(notebook):
        cell.source = 'print("all tests passed")'


def _tag_to_skip(notebook: NotebookNode) -> None:
    for cell in _grade_cells(notebook):
        cell.metadata['tags'] = ['skip-execution', 'raises-exception']
        cell.metadata.nbgrader['points'] = 100


def _split_answer(notebook: NotebookNode) -> None:
    """Split the answer before its class, as JupyterLab does: both parts keep the metadata."""
    index = next(i for i, c in enumerate(notebook.cells) if grade_id(c) == 'five_hz')
    first = notebook.cells[index]
    second = nbformat.from_dict(first)
    first.source, rest = first.source.split('\n\nclass ')
    second.source, second.id = 'class ' + rest, 'five_hz-second'
    notebook.cells.insert(index + 1, second)


DAMAGE: dict[str, Callable[[NotebookNode], None]] = {
    '03_publisher-pass-deleted_grade_cells': _delete_locked_and_grade_cells,
    '03_publisher-pass-repeated_grade_cells': _repeat_and_shuffle,
    '03_publisher-pass-split_answer': _split_answer,
    '03_publisher-fail-edited_grade_cells': _let_grade_cells_pass,
    '03_publisher-fail-skip_execution_tags': _tag_to_skip,
}


if __name__ == '__main__':
    for path in samples():
        path.write_text(rebased(path.stem, nbformat.read(path, as_version=4)), encoding='utf-8')
