"""Code that *Validate* gave up and for which grading waits longer: it is not called wrong."""

import math
from collections.abc import Sequence

from nbformat import NotebookNode

from my_robot_basics.validate.kernels.limits import STUDENT_CELL_TIMEOUT_SEC
from my_robot_basics.validate.kernels.outputs import CellRun
from my_robot_basics.validate.lessons.cells import graded_id
from my_robot_basics.validate.verdicts.trouble import TROUBLE
from my_robot_basics.validate.verdicts.verdict import Verdict

NOT_CHECKED = 'not checked, because your code did not return: look for a loop that does not end'


def judge_overdue(
    cell: NotebookNode, run: CellRun | None, given_up: Sequence[tuple[str, CellRun]]
) -> Verdict | None:
    """Return an open verdict if student code was given up; None if the cell can be judged.

    `given_up` are the student's cells that were given up. A check that passes without their end
    has passed.
    """
    if run is not None and run.ran_to_end:
        return None
    name, points = graded_id(cell), float(cell.metadata.nbgrader.points)
    if run is not None and run.given_up:
        return Verdict(name, 'ungraded', points, reason=run.given_up)
    if run is not None and run.cut_after_sec and run.error is not None:
        return Verdict(name, 'ungraded', points, reason=run.error.evalue.strip())
    if not given_up:
        return None
    notes = tuple(f'{TROUBLE}{where} {how_long(each)}' for where, each in given_up)
    return Verdict(name, 'ungraded', points, reason=NOT_CHECKED, notes=notes)


def how_long(run: CellRun) -> str:
    """Return how long Validate waited for a cell, and how long grading does, in words."""
    interrupted = 'could not be interrupted' if run.died else 'was interrupted'
    return (
        f'did not return within {rounded_down(run.cut_after_sec):g} s and {interrupted};'
        f' at grading it has {STUDENT_CELL_TIMEOUT_SEC:g} s'
    )


def rounded_down(seconds: float) -> float:
    """Round seconds down to tenths."""
    return math.floor(seconds * 10) / 10
