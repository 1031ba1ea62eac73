"""Keep what was typed into a released notebook before a new release replaces it."""

import shutil
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path

import nbformat
from my_robot_basics.validate.lessons.cells import KEY
from nbformat import NotebookNode
from nbgrader.utils import compute_checksum

from grader.common.files import make_folder_for


def keep_work(replaced: Mapping[str, Path], folder: Path, *, metadata: Mapping) -> dict[str, Path]:
    """Copy the notebooks that somebody has worked in; return the copies by name.

    `replaced` has the notebooks that are about to be replaced, by name. The copies are put into a
    new subfolder of `folder`, named after the time. `metadata` is that of a released notebook.
    """
    worked_in = {name: path for name, path in replaced.items() if _is_worked_in(path, metadata)}
    if not worked_in:
        return {}
    place = make_folder_for(datetime.now().astimezone(), folder)
    return {name: Path(shutil.copy2(path, place / path.name)) for name, path in worked_in.items()}


def _is_worked_in(path: Path, metadata: Mapping) -> bool:
    """Whether a released notebook has been saved by an editor, run, or answered since."""
    try:
        notebook = nbformat.read(path, as_version=4)
    except FileNotFoundError:
        return False
    except (OSError, ValueError, nbformat.ValidationError):
        return True  # it can't be a release's unchanged file
    kept = {name: value for name, value in notebook.metadata.items() if name != KEY}
    return kept != metadata or any(_is_touched(cell) for cell in notebook.cells)


def _is_touched(cell: NotebookNode) -> bool:
    marks = cell.metadata.get('nbgrader', {})
    if marks.get('solution') and marks.get('checksum') != compute_checksum(cell):
        return True
    return cell.get('execution_count') is not None
