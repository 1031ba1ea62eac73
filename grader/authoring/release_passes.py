"""What a source notebook goes through on its way to students: nbgrader's passes, and our own.

An answer is released as a stub; or as broken code, where students are to fix something. The lines
of that stand as comments right behind the answer, and take the stub's place:

    ### BEGIN SOLUTION
    self.timer = self.create_timer(0.2, self.tick)
    ### END SOLUTION
    ### BROKEN: self.timer = self.create_timer(5.0, self.tick)
"""

import re

import nbformat
from my_robot_basics.validate.safe_outputs import WIDGET_VIEW
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
"""What happens to a source notebook, in order; up to SaveCells it is what the gradebook keeps."""

CODE_STUB = {'python': '# YOUR CODE HERE'}
"""What stands for an answer: it runs, so that the checks can say what is missing."""

KERNELSPEC = {'display_name': 'Python 3 (ipykernel)', 'language': 'python', 'name': 'python3'}
METADATA = {'kernelspec': KERNELSPEC, 'language_info': {'name': 'python'}}
CELL_METADATA = ('nbgrader', 'tags', 'deletable', 'editable')


class TidyMetadata(Preprocessor):
    """Keep the metadata that a lesson needs; drop what an editor or a kernel left behind."""

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
    """Put broken code, where an answer has some, in the place of the stub."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Uncomment the broken lines of one cell. Raises CourseError where they stand alone."""
        cell.source = broken(cell.source)
        return cell, resources


def broken(cleared: str) -> str:
    """Return the source of an answer cell, cleared of its answer, with its broken lines as code.

    Raises CourseError when such lines are anywhere but right after an answer.
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
    """Tag the cells that check answers: where one fails, JupyterLab still runs the cells below.

    Its error is still shown. nbgrader looks at outputs alone, and what we grade and validate is
    made from solutions/, where no cell has this tag.
    """

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Tag one cell, if it is locked code: it runs an answer, or checks it."""
        if cell.cell_type == 'code' and cell.metadata.get('nbgrader', {}).get('locked'):
            cell.metadata['tags'] = [*cell.metadata.get('tags', []), 'raises-exception']
        return cell, resources


class KeepDemoOutputs(Preprocessor):
    """Clear all outputs but those of demonstrations: they show on GitHub before anything runs."""

    enabled = True

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict, index: int
    ) -> tuple[NotebookNode, dict]:
        """Clear one cell; its number goes in any case, since it changes with each run."""
        if cell.cell_type == 'code':
            cell.execution_count = None
            if 'demo' not in cell.metadata.get('tags', ()):
                cell.outputs = []
            for output in cell.outputs:
                if output.output_type == 'execute_result':
                    output.execution_count = None
                output.get('data', {}).pop(WIDGET_VIEW, None)  # blank without its running kernel
        return cell, resources
