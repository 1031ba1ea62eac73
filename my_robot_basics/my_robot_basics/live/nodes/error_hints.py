"""Say below an exception of a cell what to do about it, where Python's or rclpy's words do not.

The sentence is the one that Validate and the feedback have for the same exception. Imports nothing
that is slow.
"""

from typing import Any

from my_robot_basics.live.nodes import not_run
from my_robot_basics.session import cells_run, kernel
from my_robot_basics.session.errors import tell, without_signatures


def watch() -> None:
    """From now on, look after each cell of a student's own notebook; again, it does nothing."""
    kernel.call_after_cells(_after_cell)


def _after_cell(result: Any) -> None:
    error = result.error_before_exec or result.error_in_exec
    # the course's own exceptions say themselves what to do
    if error is None or hasattr(error, '_render_traceback_') or not_run.number_of_cell(error):
        return
    from my_robot_basics.feedback.errors import shorten
    from my_robot_basics.feedback.python_errors import hint_for_exception

    said = without_signatures(cells_run.error_of(cells_run.current()))
    line = ''
    if isinstance(error, SyntaxError) and error.text:  # often only the line shows the cause
        line = ' '.join(['', '(line', f'{error.lineno}:', f'{error.text.strip()})'])
    if why := hint_for_exception(said + line):
        raised = shorten(said)
        told = f'this cell raised `{raised}`'
        tell(told + why, in_one=False)
