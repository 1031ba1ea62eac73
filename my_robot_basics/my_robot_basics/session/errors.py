"""What goes wrong in a lesson, in a line or two: no traceback of ours in a student's notebook."""

import textwrap

COLUMNS = 90
"""What fits beside a file browser; JupyterLab breaks words, and Validate cuts long lines off."""


def in_lines(text: str) -> list[str]:
    """`text` in lines that end between words."""
    return textwrap.wrap(text, COLUMNS, break_long_words=False, break_on_hyphens=False)


class LiveError(Exception):
    """Base of the errors of `live`; IPython shows the message alone."""

    def _render_traceback_(self) -> list[str]:
        return in_lines(f'{type(self).__name__}: {self}')


class NoFreeDomain(LiveError):
    """Every ROS domain of this machine is taken."""


class BadDomain(LiveError):
    """The environment names a ROS domain that cannot be used."""


class NotRunnable(LiveError):
    """`run`, `run_answer` or `wait_until` was given something that it cannot start or call."""


class WaitTimeout(LiveError, TimeoutError):
    """What a cell waited for did not happen in time."""
