"""What goes wrong in a lesson, in a line or two: no traceback of ours in a student's notebook."""

import re

from my_robot_basics.language import lines
from my_robot_basics.language.speaking import in_language_here

COLUMNS = 90
"""What fits beside a file browser; JupyterLab breaks words, and Validate cuts long lines off."""

_SIGNATURES = re.compile(r'\. The following argument types are supported:.*', re.DOTALL)
"""What rclpy's functions in C++ take, and what they were given: in words of C++, for pages."""


def in_lines(text: str, *, first: str = '') -> list[str]:
    """`text` in lines that end between words; `first` is put before the first one."""
    return lines.in_lines(text, COLUMNS, first=first)


def tell(text: str, *, in_one: bool = True) -> None:
    """Print a sentence of the course's in the reader's language, in one line or several."""
    shown = in_language_here(text)
    lines = [shown] if in_one else in_lines(shown)
    # in one piece: an interrupt between the text and its end would leave the line open
    print('\n'.join([*lines, '']), end='', flush=True)


def without_signatures(said: str) -> str:
    """Return what an exception says, without the signatures of rclpy's functions in C++."""
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
    """rclpy was given a type of another kind than it expects, where it would crash."""


class WaitTimeout(LiveError, TimeoutError):
    """What a cell waited for did not happen in time."""
