"""Put the sample class back onto the lessons as they are released today.

    .venv/bin/python tests/submissions/rebase.py

Each sample keeps its answers and its own cells (those whose id begins with `own-`); all else comes
from notebooks/, those in more/ without the demonstrations: shorter to read, and to run whole. A
sample whose point is a damaged notebook is damaged again; one of which nothing can be read
(`-zero-`) stays as it is. A new sample is a copy of another one with another answer, and
a line in expected/<assignment>.json. Where a package is handed in, the sample is named after a
change in tests/changed_packages.py.
"""

import sys
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

import nbformat
from nbformat import NotebookNode

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from grader.course import Course
from grader.notebook.restore import KEY, grade_id, role

FOLDER = Path(__file__).parent


def samples() -> list[Path]:
    """Return every notebook of the sample class, the demo's first, then those in more/."""
    return [*sorted(FOLDER.glob('*.ipynb')), *sorted(FOLDER.glob('more/*.ipynb'))]


def assignment_of(sample: Path) -> str:
    """Return the assignment that a sample is named after: `<assignment>-<outcome>-<why>`."""
    return sample.stem.split('-', maxsplit=1)[0]


def rebased(sample: Path, *, with_demos: bool | None = None) -> str:
    """Return the text of a sample's file on today's release; as it is kept, unless told."""
    text = sample.read_text(encoding='utf-8')
    if '-zero-' in sample.stem:
        return text
    answers, own = _of_student(nbformat.reads(text, as_version=4))
    notebook = Course().release(assignment_of(sample))
    notebook.metadata.pop(KEY)  # what Validate reads: it tells of demonstrations, too
    cells = [*own[None]]
    for cell in notebook.cells:
        if cell.cell_type == 'code':
            cell.outputs, cell.execution_count = [], None
        if role(cell) == 'answer' and not _is_unanswered(sample):
            cell.source = '\n\n'.join(answers[grade_id(cell)])
        cells += [cell, *own[cell.id]]
    if with_demos is None:
        with_demos = sample.parent == FOLDER
    notebook.cells = [cell for cell in cells if with_demos or role(cell) != 'demo']
    DAMAGE.get(sample.stem, lambda notebook: None)(notebook)
    return nbformat.writes(notebook) + '\n'


def _is_unanswered(sample: Path) -> bool:
    """Whether a sample leaves its answers as they are released."""
    return sample.stem.endswith(('-untouched', '-skip_execution_tags'))


def _of_student(
    notebook: NotebookNode,
) -> tuple[dict[str, list[str]], dict[str | None, list[NotebookNode]]]:
    """Return the parts of each answer, and the student's own cells by the cell they follow."""
    answers, own, place = defaultdict(list), defaultdict(list), None
    for cell in notebook.cells:
        if cell.id.startswith('own-'):
            own[place].append(cell)
            continue
        place = cell.id
        if role(cell) == 'answer':
            answers[grade_id(cell)].append(cell.source)
    return answers, own


def _grade_cells(notebook: NotebookNode) -> list[NotebookNode]:
    return [cell for cell in notebook.cells if role(cell) == 'grade']


def _delete_locked_and_grade_cells(notebook: NotebookNode) -> None:
    notebook.cells = [cell for cell in notebook.cells if role(cell) not in ('locked', 'grade')]


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
    index = next(i for i, c in enumerate(notebook.cells) if role(c) == 'answer')
    first = notebook.cells[index]
    second = nbformat.from_dict(first)
    first.source, rest = first.source.split('\n\nclass ')
    second.source, second.id = 'class ' + rest, f'{first.id}-second'
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
        path.write_text(rebased(path), encoding='utf-8')
