"""What each notebook kernel of this Python loads at its start, an extension of IPython.

Importing `live` changes nothing. The kernel is set up by the first cell whose text names it,
before that cell runs: it may initialise rclpy itself.
"""

import re
from typing import Any

from my_robot_basics.checks import tick
from my_robot_basics.session.errors import LiveError

_NAMES_LIVE = re.compile(r'\bmy_robot_basics\b.*\blive\b')


def load_ipython_extension(shell: Any) -> None:
    """Wait for that cell; say from now on below checks that they pass."""
    tick.watch()

    def before_cell(info: Any) -> None:
        if _NAMES_LIVE.search(info.raw_cell or ''):
            shell.events.unregister('pre_run_cell', before_cell)
            _set_up()

    shell.events.register('pre_run_cell', before_cell)


def _set_up() -> None:
    from my_robot_basics.live import runner  # takes a while: rclpy comes with it

    try:
        runner.set_up()
    except LiveError as error:
        print(error)  # `run` raises it, too; a cell that does without has been told
