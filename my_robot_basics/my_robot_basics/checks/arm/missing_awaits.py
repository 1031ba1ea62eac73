"""Name a forgotten `await` in place of its effects: without it, no step of a move waits."""

import re
from collections.abc import Iterator
from contextlib import contextmanager

from my_robot_basics.exchange import node_troubles
from my_robot_basics.feedback.errors import CheckFailed, fail_with_hint
from my_robot_basics.feedback.hidden import student_text

_FIRST = re.compile('fix that first')
"""How a hint ends that names something else which has to be fixed before all others."""


@contextmanager
def naming_missing_await() -> Iterator[None]:
    """Give a failure the hint that names the missing `await`, if the notebook reports one."""
    try:
        yield
    except CheckFailed as failure:
        name, number, line = node_troubles.not_awaited()
        if not name or _FIRST.search(str(failure)):
            raise
        coroutine, line_number, call = map(student_text, (name, number, line))
        fail_with_hint(
            failure,
            f'line {line_number} calls `{coroutine}` without `await`, so nothing waits there '
            f'({call}); write `await` in front of the call, and fix that first',
        )
