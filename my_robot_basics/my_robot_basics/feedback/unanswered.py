"""What a student reads instead of a check's verdict as long as there is no answer that runs."""

import re

from my_robot_basics.feedback.errors import shorten
from my_robot_basics.feedback.python_errors import hint_for_exception

PLACEHOLDER = re.compile('YOUR CODE HERE')
"""What a released answer cell has in place of the answer. A cell without it holds code to fix:
there, the failure of a check is a part of the exercise."""


def say_unanswered(name: str) -> tuple[str, str]:
    """Return the sentence for an exercise of that name, and the hint at its end."""
    hint = f'write it into the answer cell `{name}`, where it says YOUR CODE HERE'
    expected, seen = f'an answer to `{name}`', 'none yet'  # a page shows each by itself
    return f'expected {expected}, saw {seen}: {hint}', hint


def say_stopped(name: str, error: str) -> str:
    """Return the sentence for an answer cell that stopped with an error: 'NameError: …'."""
    raised, why = shorten(error), hint_for_exception(error)
    expected = f'the answer cell `{name}` to run to its end'
    alone = f'it raised `{raised}`'  # a clause with a place of its own follows no other place
    seen = alone + why if why else f'`{raised}`'
    hint = f'correct `{name}` and run it, then run this cell again'
    return f'expected {expected}, saw {seen}: {hint}'
