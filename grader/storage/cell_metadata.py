"""nbgrader's check of the metadata of its cells, made once for each lesson."""

import json

from nbformat import NotebookNode
from nbgrader.preprocessors import CheckCellMetadata

_found_valid: set[str] = set()


class CheckMetadataOnce(CheckCellMetadata):
    """Refuse what nbgrader refuses; what it has let pass is not looked at again.

    All submissions of a lesson have the same of it, and for each cell nbgrader checks its own
    schema, too. It looks at nothing else of a notebook than what is compared here.
    """

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Return the notebook as it is. Raises ValidationError where its metadata is wrong."""
        marked = [cell for cell in nb.cells if 'nbgrader' in cell.metadata]
        seen = json.dumps([(c.cell_type, c.metadata.nbgrader) for c in marked], sort_keys=True)
        if seen not in _found_valid:
            super().preprocess(nb, resources)
            _found_valid.add(seen)
        return nb, resources
