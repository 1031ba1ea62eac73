"""Whether a failing check of a student's own notebook has no answer yet: the cell is as released.

This is asked only when a check fails. Imports nothing that is slow.
"""

import json
import os
from pathlib import Path
from typing import Any

from my_robot_basics.session import kernel

_run: dict[str, str] = {}
"""The text of each cell that was run, by cell id; the one that runs now is the last."""


def watch() -> None:
    """From now on, note the cells that are run; a second call does nothing."""
    kernel.call_before_cells(_note)


def instead() -> str:
    """Return what is said instead of the failure of the check that runs now, or ''."""
    from my_robot_basics.feedback.unanswered import PLACEHOLDER, say_unanswered
    from my_robot_basics.validate.lessons.cells import KEY, RECORD, fingerprint

    lesson = _lesson()
    marks = _answer_before(lesson.get('cells', ()), next(reversed(_run), ''))
    name, text = marks.get('grade_id', ''), _run.get(marks.get('cell_id', ''), '')
    record = lesson.get('metadata', {}).get(KEY, {}).get(RECORD, {})
    is_released = record.get(name, {}).get('source') == fingerprint(text)
    return say_unanswered(name)[0] if PLACEHOLDER.search(text) and is_released else ''


def _note(info: Any) -> None:
    cell_id = getattr(info, 'cell_id', None) or ''
    _run.pop(cell_id, None)
    _run[cell_id] = info.raw_cell or ''


def _lesson() -> dict[str, Any]:
    """Return this kernel's notebook as it was saved last; {} if it is unknown."""
    path = Path(os.environ.get('JPY_SESSION_NAME', ''))
    try:
        lesson = json.loads(path.read_text(encoding='utf-8'))
    except (OSError, ValueError):
        return {}
    return lesson if isinstance(lesson, dict) else {}


def _answer_before(cells: list[dict[str, Any]], check_id: str) -> dict[str, str]:
    """Return the ids of the answer cell to which that check belongs; {} if there is none."""
    found: dict[str, str] = {}
    for cell in cells:
        marks = cell.get('metadata', {}).get('nbgrader', {})
        if marks.get('solution') and cell.get('cell_type') == 'code':
            found = {'grade_id': marks.get('grade_id', ''), 'cell_id': cell.get('id', '')}
        elif marks.get('grade_id', '').endswith('-reset'):
            found = {}
        if cell.get('id') == check_id:
            return found if marks.get('grade') else {}
    return {}
