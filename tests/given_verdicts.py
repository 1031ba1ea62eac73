"""Verdicts without rooms; a separate module, so that worker processes import little."""

from nbformat import NotebookNode
from nbformat.v4 import new_output

from grader.notebook.restore import KEY


def executed(notebook: NotebookNode, reasons: dict[str, str | None]) -> NotebookNode:
    """Replace the rooms: give each grade cell a verdict; None passes, '?…' is ungraded."""
    for cell in notebook.cells:
        marks = cell.metadata.get('nbgrader', {})
        if marks.get('grade') and cell.cell_type == 'code':
            reason = reasons.get(marks['grade_id']) or ''
            outcome = 'ungraded' if reason.startswith('?') else 'failed' if reason else 'passed'
            verdict = {'outcome': outcome, 'reason': reason, 'notes': []}
            cell.metadata[KEY] = {'role': 'grade'} | verdict
            cell.outputs = [new_output('stream', text='looked at it\n')]
            if outcome == 'ungraded':
                cell.outputs.append(new_output('stream', text=f'{reason}\n'))
            if outcome == 'failed':
                cell.outputs.append(
                    new_output('error', ename='CheckFailed', evalue=reason, traceback=[reason])
                )
    return notebook
