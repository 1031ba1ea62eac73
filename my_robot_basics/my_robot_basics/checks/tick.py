"""Say in a student's own notebook that a check has passed: a cell that shows nothing leaves doubt.

One hook for all of them, after each cell that ran; the grader's rooms have none.
"""

import ast
import os
from typing import Any

from my_robot_basics.session import kernel

PASSED = '✓ All checks in this cell pass.'

_CHECKS = 'my_robot_basics.checks'
_watched: list[Any] = []


def watch() -> None:
    """From now on, say so below each cell of a check that passes; twice does no harm."""
    shell = kernel.shell()
    if shell is None or 'MY_ROBOT_BASICS_ROOM' in os.environ or shell in _watched:
        return
    shell.events.register('post_run_cell', _tell)
    _watched.append(shell)


def is_check(source: str) -> bool:
    """Whether a cell is a check: it says what it checks, and imports what checks."""
    if _CHECKS not in source:  # most cells
        return False
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return False
    imports = [node.module for node in tree.body if isinstance(node, ast.ImportFrom)]
    return ast.get_docstring(tree) is not None and _CHECKS in imports


def _tell(result: Any) -> None:
    if result.success and is_check(result.info.raw_cell):
        print(PASSED)
