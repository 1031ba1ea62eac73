"""What a check of a student's own notebook says of its answer cell, instead of its own verdict.

Either the cell is still as released, or it stopped with an error when it was run last: then the
check looks at what an earlier run has left, which says nothing about the code in the cell.
Imports nothing that is slow.
"""

from typing import Any

from my_robot_basics.session import cells_run


def instead_of_failure() -> str:
    """Return what is said instead of the failure of the check that runs now, or ''."""
    return instead_of_pass() or _no_answer()


def instead_of_pass() -> str:
    """Return what is said below the check that has just passed, instead of that, or ''."""
    marks = _answer_of_this_check(cells_run.lesson())
    error = cells_run.error_of(marks['cell_id']) if marks else ''
    if not error:
        return ''
    from my_robot_basics.feedback.unanswered import say_stopped

    return say_stopped(marks['grade_id'], error)


def _no_answer() -> str:
    from my_robot_basics.feedback.unanswered import PLACEHOLDER, say_unanswered
    from my_robot_basics.validate.lessons.cells import KEY, RECORD, fingerprint

    lesson = cells_run.lesson()
    marks = _answer_of_this_check(lesson)
    name, text = marks.get('grade_id', ''), cells_run.text_of(marks.get('cell_id', ''))
    record = lesson.get('metadata', {}).get(KEY, {}).get(RECORD, {})
    is_released = record.get(name, {}).get('source') == fingerprint(text)
    return say_unanswered(name)[0] if PLACEHOLDER.search(text) and is_released else ''


def _answer_of_this_check(lesson: dict[str, Any]) -> dict[str, str]:
    """Return the ids of the answer cell to which the running check belongs; {} if none."""
    found: dict[str, str] = {}
    for cell in lesson.get('cells', ()):
        marks = cell.get('metadata', {}).get('nbgrader', {})
        if marks.get('solution') and cell.get('cell_type') == 'code':
            found = {'grade_id': marks.get('grade_id', ''), 'cell_id': cell.get('id', '')}
        elif marks.get('grade_id', '').endswith('-reset'):
            found = {}
        if cell.get('id') == cells_run.current():
            return found if marks.get('grade') else {}
    return {}
