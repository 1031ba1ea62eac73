"""The preprocessors for a submission, the same in `nbgrader autograde` and in `./course`."""

import copy
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import nbformat
from my_robot_basics.validate.verdicts.verdict import fail_all_checks, is_broken
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
"""What nbgrader applies to a submitted notebook first, before it is run."""

AUTOGRADE_PASSES = (
    'grader.autograde.preprocessors.ExecuteRooms',
    'nbgrader.preprocessors.LimitOutput',
    'grader.storage.save_grades.SaveGrades',
    'grader.storage.late_penalties.LatePenalties',
    'grader.storage.cell_metadata.CheckMetadataOnce',
)
"""What nbgrader applies next, to run the notebook and store its scores."""


def apply_preprocessors(
    passes: Sequence[str], notebook: NotebookNode, resources: dict
) -> NotebookNode:
    """Apply preprocessors, given by name, to a notebook as nbgrader would; return the result."""
    _, changed = normalize(notebook)  # a copy
    resources = copy.deepcopy(resources)
    for each in _make_preprocessors(tuple(passes)):
        changed, resources = each(changed, resources)
        nbformat.validate(changed, relax_add_props=True)
    return changed


@cache
def _make_preprocessors(passes: tuple[str, ...]) -> 'tuple[Preprocessor, ...]':
    """Make preprocessors as nbconvert's Exporter would; cached, because that is slow."""
    # imported late, a third of a second: what is graded already needs no preprocessors
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
    """Return the resources that nbgrader's preprocessors expect with a notebook."""
    return {
        'nbgrader': {
            'notebook': assignment,
            'assignment': assignment,
            'student': student_id,
            'db_url': course.db_url,
            'gradebook': str(course.gradebook),
        }
    }


def sanitize_restored(course: Course, assignment: str, restored: NotebookNode) -> NotebookNode:
    """Do to a restored notebook what nbgrader does first: checksums, kernel, metadata."""
    return apply_preprocessors(
        _passes_after('grader.autograde.preprocessors.RestoreSubmission', SANITIZE_PASSES),
        restored,
        resources_of(course, assignment),
    )


def make_sanitized_template(course: Course, assignment: str) -> AssignmentTemplate:
    """Return the template of an assignment's submissions, after `sanitize_restored`.

    A notebook restored from it need not be sanitized: only cells of the template are changed.
    """
    return sanitize_template(course, assignment, course.template(assignment))


def sanitize_template(
    course: Course, assignment: str, template: AssignmentTemplate
) -> AssignmentTemplate:
    """Sanitize a template, once for all submissions that are restored from it."""
    return replace(template, notebook=sanitize_restored(course, assignment, template.notebook))


def store_scores(executed: NotebookNode, resources: dict) -> NotebookNode:
    """Do to an executed notebook, in place, what nbgrader does next: store the scores.

    Raises ValidationError, and stores nothing, if it is not a valid notebook.
    """
    nbformat.validate(executed, relax_add_props=True)
    passes = _passes_after('grader.autograde.preprocessors.ExecuteRooms', AUTOGRADE_PASSES)
    for each in _make_preprocessors(passes):
        executed, resources = each(executed, resources)
    return executed


def make_unanswered(template: AssignmentTemplate, reason: str) -> NotebookNode:
    """Return a notebook for a submission that can't be graded: unanswered, with the reason.

    The template is a prepared one.
    """
    notebook = restore(nbformat.v4.new_notebook(), template).notebook
    notebook.metadata[KEY] |= {'notes': [reason], 'problem': reason}
    fail_all_checks(notebook, reason)
    return notebook


def is_undecided(graded: NotebookNode) -> bool:
    """Whether a check of an executed notebook could not decide, and has no score for that."""
    return any(cell.metadata.get(KEY, {}).get('outcome') == 'ungraded' for cell in graded.cells)


def has_broken_checks(graded: NotebookNode) -> bool:
    """Whether the test kernel crashed or hung at a check, which no busy machine explains.

    An answer can cause it by what it sends to Fast DDS.
    """
    verdicts = [cell.metadata.get(KEY, {}) for cell in graded.cells]
    return any(v.get('outcome') == 'ungraded' and is_broken(v.get('reason', '')) for v in verdicts)


def first_reason(graded: NotebookNode) -> str:
    """Return the first reason why points are missing in an executed notebook, or ''.

    That there is no answer at all explains all that is missing. An error in the student's own
    cells comes before the reason of the check.
    """
    restored = graded.metadata.get(KEY, {})
    if problem := restored.get('problem'):
        return problem
    for cell in graded.cells:
        verdict = cell.metadata.get(KEY, {})
        if verdict.get('outcome') in ('partial', 'failed', 'ungraded') and verdict.get('reason'):
            if NO_ANSWERS in restored.get('notes', ()):
                return NO_ANSWERS
            return '; '.join([*verdict.get('notes', ())[:1], verdict.reason])
    return ''


def _passes_after(name: str, passes: tuple[str, ...]) -> tuple[str, ...]:
    return passes[passes.index(name) + 1 :]
