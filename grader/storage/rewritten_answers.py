"""Points given by hand count no more once the student has rewritten the answer."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from nbformat import NotebookNode

from grader.notebook.own_notebooks import parse_own_notebook
from grader.notebook.restore import KEY, grade_id, role

EARLIER_POINTS = 'earlier_points'
"""In the verdict of a rewritten answer: the points that its earlier text was given by hand."""


def note_rewritten(graded: NotebookNode, former_path: Path, points: dict[str, float]) -> None:
    """Note in the verdicts of rewritten answers which points given by hand count no more.

    `former_path` is the executed notebook of the hand-in before, `points` what a person has given
    for it, by grade id. An answer is not rewritten if only the space around it has changed. If
    nothing shows what the earlier text was, the points stay. A note stays until a person has read
    the answer.
    """
    former = _answers(former_path)
    for cell in graded.cells:
        name, verdict = grade_id(cell), cell.metadata.get(KEY, {})
        if name not in former:
            continue
        if name in points:
            is_rewritten = former[name].source.strip() != cell.source.strip()
            earlier = points[name] if is_rewritten else None
        else:
            earlier = former[name].metadata.get(KEY, {}).get(EARLIER_POINTS)
        if EARLIER_POINTS in verdict:  # a kept result, which a person may have read since
            del verdict[EARLIER_POINTS], verdict['reason']
        if earlier is not None:
            verdict[EARLIER_POINTS] = earlier
            verdict['reason'] = (
                f'this answer was changed after {earlier:g} points had been given for it by hand: '
                'a person reads it again'
            )


def reason_today(verdict: Mapping[str, Any], *, by_hand: bool) -> str:
    """Return a verdict's reason; '' if a person has since read a rewritten answer, or decided."""
    is_settled = EARLIER_POINTS in verdict or verdict.get('outcome') == 'ungraded'
    return '' if by_hand and is_settled else verdict.get('reason', '')


def _answers(path: Path) -> dict[str, NotebookNode]:
    """Return the written answers of an executed notebook, by grade id; none if it is damaged."""
    try:
        notebook = parse_own_notebook(path.read_text('utf-8'))
    except (FileNotFoundError, ValueError):
        return {}
    answers = [cell for cell in notebook.cells if role(cell) == 'answer']
    return {name: cell for cell in answers if (name := grade_id(cell))}
