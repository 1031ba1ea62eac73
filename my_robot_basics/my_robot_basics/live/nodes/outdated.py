"""Say below a check that the answer has been changed since its node was made.

Students who correct an answer and run its check again often forget the cell with `run_answer`
between the two: then the check looks at the node of the answer before. *Validate* runs all cells.
"""

import sys
from typing import Any

from my_robot_basics.checks.clock.tick import is_check
from my_robot_basics.live.nodes import answer_end
from my_robot_basics.session import kernel
from my_robot_basics.session.errors import tell
from my_robot_basics.session.neighbours import nodes_here


def watch() -> None:
    """From now on, look after each check in a student's own notebook; again, it does nothing."""
    kernel.call_after_cells(_after_cell)


def _after_cell(result: Any) -> None:
    name = answer_end.running_answer()
    if name and is_check(result.info.raw_cell or '') and _is_of_an_earlier_class(name):
        tell(
            f'the node that was checked is from before {name} was changed: run the cell with '
            'run_answer again, and then this one',
            in_one=False,
        )


def _is_of_an_earlier_class(name: str) -> bool:
    """Whether a node of a class of this name exists, and none of the notebook's present class."""
    present = vars(sys.modules['__main__']).get(name)
    classes = {type(node) for node in nodes_here() if type(node).__name__ == name}
    return bool(classes) and present is not None and present not in classes
