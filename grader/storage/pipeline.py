"""The passes that a submission goes through, the same for `nbgrader autograde` and for us."""

import copy
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import nbformat
from my_robot_basics.validate.verdict import refuse
from nbformat import NotebookNode
from nbformat.validator import normalize

from grader.course import Course
from grader.notebook.restore import KEY, NO_ANSWERS, AssignmentTemplate, restore

if TYPE_CHECKING:
    from nbconvert.preprocessors import Preprocessor

SANITIZE_PASSES = (
    'grader.autograde.preprocessors.RestoreSubmission',
    'nbgrader.preprocessors.OverwriteKernelspec',
    'nbgrader.preprocessors.OverwriteCells',
    'nbgrader.preprocessors.CheckCellMetadata',
)
"""What nbgrader does with a submitted notebook before it runs."""

AUTOGRADE_PASSES = (
    'grader.autograde.preprocessors.ExecuteRooms',
    'nbgrader.preprocessors.LimitOutput',
    'grader.storage.save_grades.SaveGrades',
    'grader.storage.late_penalties.LatePenalties',
    'grader.storage.cell_metadata.CheckMetadataOnce',
)
"""What nbgrader does with it then."""


def apply(passes: Sequence[str], notebook: NotebookNode, resources: dict) -> NotebookNode:
    """Put a notebook through passes, given by name, as nbgrader would; return the result."""
    _, changed = normalize(notebook)  # a copy
    resources = copy.deepcopy(resources)
    for each in _made(tuple(passes)):
        changed, resources = each(changed, resources)
        nbformat.validate(changed, relax_add_props=True)
    return changed


@cache
def _made(passes: tuple[str, ...]) -> 'tuple[Preprocessor, ...]':
    """Make passes as nbconvert's Exporter would; once: it takes longer than their work."""
    # only now: what is graded already needs no passes, and these take a third of a second
    from nbconvert.preprocessors import Preprocessor  # noqa: F401
    from traitlets.config import Config
    from traitlets.utils.importstring import import_item

    from grader.authoring.release_passes import CODE_STUB

    config = Config(
        {
            'ClearSolutions': {'code_stub': CODE_STUB},
            'ClearMarkScheme': {'enforce_metadata': False},
        }
    )
    return tuple(import_item(name)(config=config) for name in passes)


def resources_of(course: Course, assignment: str, student_id: str = '.') -> dict:
    """Return what nbgrader's passes want to know of the notebook that they get."""
    return {
        'nbgrader': {
            'notebook': assignment,
            'assignment': assignment,
            'student': student_id,
            'db_url': course.db_url,
            'gradebook': str(course.gradebook),
        }
    }


def prepare(course: Course, assignment: str, restored: NotebookNode) -> NotebookNode:
    """Do to a restored notebook what nbgrader does before it runs: checksums, kernel, metadata."""
    return apply(
        _after('grader.autograde.preprocessors.RestoreSubmission', SANITIZE_PASSES),
        restored,
        resources_of(course, assignment),
    )


def prepared_template(course: Course, assignment: str) -> AssignmentTemplate:
    """Return what submissions are restored from with all done to it that `prepare` does.

    What is restored from it need not be prepared: whatever nbgrader changes is the template's.
    """
    return prepare_template(course, assignment, course.template(assignment))


def prepare_template(
    course: Course, assignment: str, template: AssignmentTemplate
) -> AssignmentTemplate:
    """Do to a template, once for all submissions, what `prepare` does to what is restored."""
    return replace(template, notebook=prepare(course, assignment, template.notebook))


def finish(executed: NotebookNode, resources: dict) -> NotebookNode:
    """Do with an executed notebook, in place, what nbgrader does then: it stores the scores.

    Raises ValidationError, and stores nothing, where it is no notebook.
    """
    nbformat.validate(executed, relax_add_props=True)
    for each in _made(_after('grader.autograde.preprocessors.ExecuteRooms', AUTOGRADE_PASSES)):
        executed, resources = each(executed, resources)
    return executed


def unanswered(template: AssignmentTemplate, reason: str) -> NotebookNode:
    """Return what stands for a submission that can't be graded: nothing answered, and why.

    The template is a prepared one.
    """
    notebook = restore(nbformat.v4.new_notebook(), template).notebook
    notebook.metadata[KEY] |= {'notes': [reason], 'problem': reason}
    refuse(notebook, reason)
    return notebook


def first_reason(graded: NotebookNode) -> str:
    """Return the first reason why points are missing in an executed notebook, or ''.

    What went wrong in the student's own cells comes before what the check then saw.
    """
    restored = graded.metadata.get(KEY, {})
    if problem := restored.get('problem'):
        return problem
    for cell in graded.cells:
        verdict = cell.metadata.get(KEY, {})
        if verdict.get('outcome') in ('partial', 'failed', 'ungraded') and verdict.get('reason'):
            causes = [note for note in restored.get('notes', ()) if note == NO_ANSWERS]
            return '; '.join([*causes, *verdict.get('notes', ())[:1], verdict.reason])
    return ''


def _after(name: str, passes: tuple[str, ...]) -> tuple[str, ...]:
    return passes[passes.index(name) + 1 :]
