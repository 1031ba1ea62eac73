"""The IPython extension that each notebook kernel of this Python loads at its start.

Files beside a notebook can be imported only once a cell is run, and replace no installed module: a
kernel starts when a notebook is opened, and what a stranger put beside it must not run then.

Importing `live` changes nothing. The first cell whose text names `live` sets the kernel up, before
that cell runs, because it may initialise rclpy itself.
"""

import re
import sys
from typing import Any

from my_robot_basics.checks.clock import tick
from my_robot_basics.checks.topics import untouched
from my_robot_basics.live.nodes import error_hints, not_run
from my_robot_basics.session import cells_run, classroom
from my_robot_basics.session.errors import LiveError

_NAMES_LIVE = re.compile(r'\bmy_robot_basics\b.*\blive\b')


def load_ipython_extension(shell: Any) -> None:
    """Wait for that cell; from now on, show a tick below checks that pass."""
    cells_run.watch()
    tick.watch(instead=untouched.instead_of_pass)
    not_run.watch()
    error_hints.watch()

    def before_cell(info: Any) -> None:
        if _NAMES_LIVE.search(info.raw_cell or ''):
            shell.events.unregister('pre_run_cell', before_cell)
            _set_up()

    def before_first_cell(_: Any) -> None:
        shell.events.unregister('pre_run_cell', before_first_cell)
        if '' not in sys.path:  # other programs may start a kernel without `-P`
            sys.path.append('')

    shell.events.register('pre_run_cell', before_cell)
    if not classroom.in_grading_room():  # rooms add the student's files themselves
        shell.events.register('pre_run_cell', before_first_cell)


def _set_up() -> None:
    from my_robot_basics.live.nodes import runner  # slow, because it imports rclpy

    try:
        runner.set_up()
    except LiveError as error:
        print(error)  # not raised: the cell may not need `run`, which raises it again
