"""Record in a released notebook what *Validate* needs and its cells no longer show."""

from my_robot_basics.feedback.hidden_source import without_hidden_part
from my_robot_basics.validate.lessons.cells import KEY, RECORD, fingerprint, grade_id, roles
from my_robot_basics.validate.lessons.titles import checks_something
from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode


class MarkHidden(Preprocessor):
    """Record each cell's role, and which checks have a hidden part, before it is removed."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Begin the record in the notebook's metadata; it has nothing of the hidden content."""
        record = {}
        for cell, role in zip(nb.cells, roles(nb), strict=True):
            if role != 'text':
                record[_key(cell)] = {'role': role}
            if role == 'grade' and (shown := without_hidden_part(cell.source)) != cell.source:
                record[_key(cell)]['hidden'] = 'part' if checks_something(shown) else 'all'
        nb.metadata[KEY] = {RECORD: record}
        return nb, resources


class MarkSources(Preprocessor):
    """Record a hash of each cell's released source, so that a change can be detected."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Complete the record."""
        for cell in nb.cells:
            if mark := nb.metadata[KEY][RECORD].get(_key(cell)):
                mark['source'] = fingerprint(cell.source)
                if points := cell.metadata.get('nbgrader', {}).get('points'):
                    mark['points'] = points
        return nb, resources


def _key(cell: NotebookNode) -> str:
    """Return a cell's key in the record: its grade id, or else the cell id."""
    return grade_id(cell) or cell.id
