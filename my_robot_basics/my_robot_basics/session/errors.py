"""The errors of a lesson in a line or two: students see no traceback of the course's code."""

import re

from my_robot_basics.language import lines
from my_robot_basics.language.speaking import in_language_here

COLUMNS = 90
"""Columns beside a file browser; JupyterLab breaks longer lines in words, Validate cuts them."""

_SIGNATURES = re.compile(r'\. The following argument types are supported:.*', re.DOTALL)
"""The long list of C++ signatures and arguments at the end of pybind11's TypeError."""


def in_lines(text: str, *, first: str = '') -> list[str]:
    """Return a text as lines that end between words; `first` is put before the first one."""
    return lines.in_lines(text, COLUMNS, first=first)


def tell(text: str, *, in_one: bool = True) -> None:
    """Print a sentence of the course in the reader's language, in one line or several."""
    shown = in_language_here(text)
    lines = [shown] if in_one else in_lines(shown)
    # one call: an interrupt between the text and its newline would leave the line open
    print('\n'.join([*lines, '']), end='', flush=True)


def without_signatures(said: str) -> str:
    """Return an exception's text without the signatures of rclpy's C++ functions."""
    return _SIGNATURES.sub('', said)


class LiveError(Exception):
    """Base of the errors of `live`; IPython shows the message alone."""

    def _render_traceback_(self) -> list[str]:
        return in_lines(f'{type(self).__name__}: {in_language_here(str(self))}')


class NoFreeDomain(LiveError):
    """Every ROS domain of this machine is taken."""


class BadDomain(LiveError):
    """The environment names a ROS domain that cannot be used."""


class NotRunnable(LiveError):
    """`run`, `run_answer` or `wait_until` was given something that it cannot start or call."""


class WrongType(LiveError, TypeError):
    """A call gives a value of a wrong type, such as one with which rclpy would crash."""


class WaitTimeout(LiveError, TimeoutError):
    """What a cell waited for did not happen in time."""
