"""How `nbgrader autograde` takes the gradebook's lock: once for each submission that it grades."""

from pathlib import Path

from nbgrader.converters import Autograde

from grader.common.db_url import gradebook_of
from grader.storage.lock import gradebook_lock

_convert = Autograde.convert_single_notebook


def convert_under_lock(converter: Autograde, notebook_filename: str) -> None:
    """Restore, grade and write one notebook while no other process writes into the gradebook."""
    gradebook = gradebook_of(converter.coursedir.db_url, Path(converter.coursedir.root))
    with gradebook_lock(gradebook, converter.log.warning):
        _convert(converter, notebook_filename)


def lock_while_grading() -> None:
    """Let `nbgrader autograde` hold the lock; no option and no pass of nbgrader's can do it."""
    Autograde.convert_single_notebook = convert_under_lock
