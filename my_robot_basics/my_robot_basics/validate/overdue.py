"""What *Validate* gave up, where grading waits longer: no answer is called wrong for that."""

import math
from collections.abc import Sequence

from nbformat import NotebookNode

from my_robot_basics.validate.cells import graded_id
from my_robot_basics.validate.limits import STUDENT_CELL_TIMEOUT_SEC
from my_robot_basics.validate.outputs import CellRun
from my_robot_basics.validate.trouble import TROUBLE
from my_robot_basics.validate.verdict import Verdict

NOT_CHECKED = 'not checked, because your code did not return: look for a loop that does not end'


def judge_overdue(
    cell: NotebookNode, run: CellRun | None, given_up: Sequence[tuple[str, CellRun]]
) -> Verdict | None:
    """Leave a grade cell open where student code was given up; None where it can be judged.

    `given_up` are the student's cells that were. What passes without them has passed.
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
    """Say for how long a cell was waited for, and how long grading waits."""
    interrupted = 'could not be interrupted' if run.died else 'was interrupted'
    return (
        f'did not return within {rounded_down(run.cut_after_sec):g} s and {interrupted};'
        f' at grading it has {STUDENT_CELL_TIMEOUT_SEC:g} s'
    )


def rounded_down(seconds: float) -> float:
    """Return seconds in tenths, and no more than it was."""
    return math.floor(seconds * 10) / 10
