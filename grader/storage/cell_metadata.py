"""nbgrader's check of its cell metadata, made once for each lesson."""

import json

from nbformat import NotebookNode
from nbgrader.preprocessors import CheckCellMetadata

_found_valid: set[str] = set()


class CheckMetadataOnce(CheckCellMetadata):
    """Refuse what nbgrader refuses, but do not check metadata that has passed before.

    All submissions of a lesson have the same nbgrader metadata. The check reads only the metadata
    and the types of cells, which are compared here.
    """

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return the notebook unchanged. Raises ValidationError if its metadata is wrong."""
        marked = [cell for cell in nb.cells if 'nbgrader' in cell.metadata]
        seen = json.dumps([(c.cell_type, c.metadata.nbgrader) for c in marked], sort_keys=True)
        if seen not in _found_valid:
            super().preprocess(nb, resources)
            _found_valid.add(seen)
        return nb, resources
