"""The text of a grade cell: with a mark where its hidden part begins, or without that part."""

import ast

BEGIN, END = (f'{word} HIDDEN TESTS' for word in ('BEGIN', 'END'))
# in one piece, these words would show that something hidden was given out

_HERE = "__import__('my_robot_basics.feedback.hidden', fromlist=['begin'])"


def marked(source: str, *, quiet: bool = False) -> str:
    """A grade cell as it is run: it says where its hidden part begins.

    It is `quiet` from its first line on where the student's code knows hidden inputs already.
    """
    lines = []
    for line in source.split('\n'):
        indent = line[: len(line) - len(line.lstrip())]
        lines.append(f'{indent}{_HERE}.begin()' if BEGIN in line else line)
    lines.insert(_title_lines(source), f'{_HERE}.start(quiet={quiet})')
    return '\n'.join(lines)


def visible(source: str) -> str:
    """A grade cell as students are given it."""
    kept, inside = [], False
    for line in source.split('\n'):
        inside = (inside or BEGIN in line) and END not in line
        if not inside and END not in line:
            kept.append(line)
    return '\n'.join(kept)


def _title_lines(source: str) -> int:
    """How many lines the docstring takes, which stays the first thing of a cell."""
    first, *_ = [*ast.parse(source).body, None]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
        return first.end_lineno or 0
    return 0
