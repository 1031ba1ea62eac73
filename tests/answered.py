"""Released lessons as students hand them in: with the solutions' answers, or with others."""

import os
from pathlib import Path

import nbformat
from nbformat import NotebookNode

ROOT = Path(__file__).parents[1]
LESSONS = sorted(path.stem for path in ROOT.glob('notebooks/[0-9]*/*.ipynb'))


NOT_A_STUDENTS = ('PYTEST_', 'COV_', 'MY_ROBOT_BASICS_', 'ROS_', 'RCUTILS_', 'FASTRTPS_', 'JPY_')


def students_environment() -> dict[str, str]:
    """Return this process's environment without variables that a test session sets."""
    return {name: v for name, v in os.environ.items() if not name.startswith(NOT_A_STUDENTS)}


def read(folder: str, lesson: str) -> NotebookNode:
    """Read a lesson from solutions/ or notebooks/."""
    return nbformat.read(ROOT / folder / lesson / f'{lesson}.ipynb', as_version=4)


def answered(lesson: str, folder: Path, **answers: str) -> Path:
    """Write the released lesson with these answers, and the solutions' answers elsewhere."""
    notebook = read('notebooks', lesson)
    right = {cell.id: cell.source for cell in read('solutions', lesson).cells}
    for cell in notebook.cells:
        if cell.metadata.get('nbgrader', {}).get('solution'):
            cell.source = answers.get(cell.id, right[cell.id])
    folder.mkdir(parents=True, exist_ok=True)
    nbformat.write(notebook, path := folder / f'{lesson}.ipynb')
    return path
