"""Make `nbgrader autograde` take the gradebook's lock, once for each submission."""

from pathlib import Path

from nbgrader.converters import Autograde

from grader.common.db_url import gradebook_of
from grader.storage.lock import gradebook_lock

_convert = Autograde.convert_single_notebook


def convert_under_lock(converter: Autograde, notebook_filename: str) -> None:
    """Restore, grade and store one notebook while no other process writes into the gradebook."""
    gradebook = gradebook_of(converter.coursedir.db_url, Path(converter.coursedir.root))
    with gradebook_lock(gradebook, converter.log.warning):
        _convert(converter, notebook_filename)


def lock_while_grading() -> None:
    """Patch `nbgrader autograde` to hold the lock; none of its options or preprocessors can."""
    Autograde.convert_single_notebook = convert_under_lock
