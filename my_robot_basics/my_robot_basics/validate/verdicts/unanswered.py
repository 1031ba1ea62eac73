"""Say that an exercise is not answered yet, in place of what its checks miss in the given code."""

from dataclasses import replace

from nbformat import NotebookNode

from my_robot_basics.feedback.unanswered import PLACEHOLDER, say_unanswered
from my_robot_basics.validate.lessons.cells import KEY, RELEASED, fingerprint, graded_id
from my_robot_basics.validate.verdicts.trouble import TROUBLE
from my_robot_basics.validate.verdicts.verdict import Verdict

Checks = dict[int, tuple[Verdict, list[NotebookNode]]]
"""Verdict and outputs of each grade cell, by its position in the notebook."""


def is_unanswered(cell: NotebookNode) -> bool:
    """Whether an answer cell still has the placeholder, and nothing in it was changed."""
    is_released = cell.metadata.get(KEY, {}).get(RELEASED) == fingerprint(cell.source)
    return is_released and PLACEHOLDER.search(cell.source) is not None


def explain_unanswered(answer: NotebookNode, checks: Checks) -> Checks:
    """Return the checks of an exercise; if one failed without an answer, this is the reason."""
    if not is_unanswered(answer):
        return checks
    return {i: (_explain(answer, verdict), outputs) for i, (verdict, outputs) in checks.items()}


def _explain(answer: NotebookNode, verdict: Verdict) -> Verdict:
    if verdict.outcome != 'failed':
        return verdict
    reason, hint = say_unanswered(graded_id(answer))
    notes = tuple(note for note in verdict.notes if not note.startswith(TROUBLE))
    return replace(verdict, reason=reason, hint=hint, notes=notes)
