"""The preprocessors that make a released notebook from its source: nbgrader's and our own.

An answer is released as a stub, or as broken code that students are to fix. The broken lines are
comments right after the answer, and replace the stub:

    ### BEGIN SOLUTION
    self.timer = self.create_timer(0.2, self.tick)
    ### END SOLUTION
    ### BROKEN: self.timer = self.create_timer(5.0, self.tick)
"""

import re

import nbformat
from my_robot_basics.validate.kernels.safe_outputs import WIDGET_VIEW
from nbconvert.preprocessors import Preprocessor
from nbformat import NotebookNode

from grader.authoring.leaks import BROKEN
from grader.common.errors import CourseError

PASSES = (
    'grader.authoring.release_passes.TidyMetadata',
    'grader.authoring.exercise_cells.RequireExercises',
    'nbgrader.preprocessors.LockCells',
    'nbgrader.preprocessors.ClearSolutions',
    'grader.authoring.release_passes.ReleaseBroken',
    'grader.authoring.release_passes.KeepDemoOutputs',
    'nbgrader.preprocessors.CheckCellMetadata',
    'nbgrader.preprocessors.ComputeChecksums',
    'nbgrader.preprocessors.SaveCells',
    'grader.authoring.hidden_points.MarkHidden',
    'nbgrader.preprocessors.ClearHiddenTests',
    'nbgrader.preprocessors.ClearMarkScheme',
    'grader.authoring.hidden_points.MarkSources',
    'nbgrader.preprocessors.ComputeChecksums',
    'grader.authoring.release_passes.LetRunAllGoOn',
    'nbgrader.preprocessors.CheckCellMetadata',
)
"""The preprocessors in order; the result of those before SaveCells is stored in the gradebook."""

CODE_STUB = {'python': '# YOUR CODE HERE'}
"""It replaces an answer. It can be run, so that the checks can say what is missing."""

KERNELSPEC = {'display_name': 'Python 3 (ipykernel)', 'language': 'python', 'name': 'python3'}
METADATA = {'kernelspec': KERNELSPEC, 'language_info': {'name': 'python'}}
CELL_METADATA = ('nbgrader', 'tags', 'deletable', 'editable')


class TidyMetadata(Preprocessor):
    """Keep the metadata that a lesson needs; remove that of an editor or a kernel."""

    enabled = True

    def preprocess(self, nb: NotebookNode, resources: dict) -> tuple[NotebookNode, dict]:
        """Tidy the notebook's own metadata and that of its cells."""
        nb.metadata = nbformat.from_dict(METADATA)
        return super().preprocess(nb, resources)

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Tidy one cell."""
        kept = {key: cell.metadata[key] for key in CELL_METADATA if key in cell.metadata}
        cell.metadata = nbformat.from_dict(kept)
        return cell, resources


class ReleaseBroken(Preprocessor):
    """Replace the stub by broken code, if an answer has some."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Uncomment the broken lines of one cell. Raises CourseError if they follow no answer."""
        cell.source = uncomment_broken_lines(cell.source)
        return cell, resources


def uncomment_broken_lines(cleared: str) -> str:
    """Return an answer cell's source, cleared of its answer, with its broken lines as code.

    Raises CourseError if such lines are anywhere but right after an answer.
    """
    stub = re.escape(CODE_STUB['python'])
    after_stub = re.compile(rf'^ *{stub}\n((?: *{BROKEN}.*(?:\n|\Z))+)', re.MULTILINE)
    source = after_stub.sub(lambda found: found[1].replace(BROKEN, ''), cleared)
    if BROKEN.strip() in source:
        raise CourseError(
            f'a line with {BROKEN.strip()!r} follows no answer: write such lines right after'
            f' ### END SOLUTION, each beginning with {BROKEN!r}'
        )
    return source


class LetRunAllGoOn(Preprocessor):
    """Tag the cells that check answers: if one fails, JupyterLab still runs the cells below.

    Its error is still shown. nbgrader reads only outputs, and the notebooks that we grade and
    validate are made from solutions/, where cells do not have this tag.
    """

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Tag one cell if it is locked code: such a cell runs an answer, or checks it."""
        if cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('locked'):
            cell.metadata['tags'] = [*cell.metadata.get('tags', []), 'raises-exception']
        return cell, resources


class KeepDemoOutputs(Preprocessor):
    """Remove all outputs except those of demonstrations: GitHub shows them before any run."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Clear one cell; always remove its execution count, which changes with each run."""
        if cell.cell_type == 'code':
            cell.execution_count = None
            if 'demo' not in cell.metadata.get('tags', ()):
                cell.outputs = []
            for output in cell.outputs:
                if output.output_type == 'execute_result':
                    output.execution_count = None
                output.get('data', {}).pop(WIDGET_VIEW, None)  # needs its running kernel
        return cell, resources
