"""The database's rows for one submission's cells, read in one query and not cell by cell."""

from types import SimpleNamespace
from typing import TypeVar

from nbgrader.api import (
    BaseCell,
    Comment,
    Grade,
    Gradebook,
    MissingEntry,
    Notebook,
    SubmittedAssignment,
    SubmittedNotebook,
)
from sqlalchemy import Select, bindparam, select
from sqlalchemy.orm import undefer

Row = TypeVar('Row', Grade, Comment)


def _rows_of(kind: type[Grade] | type[Comment]) -> Select:
    return (
        select(BaseCell.name, kind)
        .join(BaseCell, BaseCell.id == kind.cell_id)
        .join(SubmittedNotebook, SubmittedNotebook.id == kind.notebook_id)
        .join(Notebook, Notebook.id == SubmittedNotebook.notebook_id)
        .where(
            SubmittedNotebook.assignment_id == bindparam('submission'),
            Notebook.name == bindparam('notebook'),
        )
        .order_by(BaseCell.type.desc())  # a TaskCell replaces another cell of the same name
    )


_GRADES = _rows_of(Grade).options(undefer(Grade.max_score))
_COMMENTS = _rows_of(Comment)


class SubmissionRows:
    """Replaces a Gradebook when nbgrader stores scores and comments of one submission.

    A Gradebook queries each cell's row by the submission's name, a join of seven tables, and
    commits after each. Here nothing is committed: the caller does that.
    """

    def __init__(self, book: Gradebook, submission: SubmittedAssignment, notebook: str) -> None:
        self.db = SimpleNamespace(commit=lambda: None)
        whose = {'submission': submission.id, 'notebook': notebook}
        self._grades = dict(book.db.execute(_GRADES, whose).all())
        self._comments = dict(book.db.execute(_COMMENTS, whose).all())

    def find_grade(self, cell: str | None, *_: str) -> Grade:
        """Return the row of a graded cell. Raises MissingEntry as nbgrader does."""
        return _row_of(self._grades, cell)

    def find_comment(self, cell: str | None, *_: str) -> Comment:
        """Return the row of an answer cell. Raises MissingEntry as nbgrader does."""
        return _row_of(self._comments, cell)


def _row_of(rows: dict[str, Row], cell: str | None) -> Row:
    if cell not in rows:
        raise MissingEntry(f'No such cell of this submission: {cell}')
    return rows[cell]
