"""The source of a grade cell: with a mark where its hidden part begins, or without that part."""

import ast

BEGIN, END = (f'{word} HIDDEN TESTS' for word in ('BEGIN', 'END'))
# written whole, these words would make a search for leaked hidden tests find this file

_HERE = "__import__('my_robot_basics.feedback.hidden', fromlist=['start_cell'])"


def mark_hidden_part(source: str, *, quiet: bool = False) -> str:
    """Return a grade cell's source as it is run: with a call where its hidden part begins.

    With `quiet`, all of it counts as hidden: the student's code knows hidden inputs already.
    """
    lines = []
    for line in source.split('\n'):
        indent = line[: len(line) - len(line.lstrip())]
        lines.append(f'{indent}{_HERE}.begin_hidden_part()' if BEGIN in line else line)
    lines.insert(_title_lines(source), f'{_HERE}.start_cell(quiet={quiet})')
    return '\n'.join(lines)


def without_hidden_part(source: str) -> str:
    """Return a grade cell's source as it is released to students."""
    kept, inside = [], False
    for line in source.split('\n'):
        inside = (inside or BEGIN in line) and END not in line
        if not inside and END not in line:
            kept.append(line)
    return '\n'.join(kept)


def _title_lines(source: str) -> int:
    """Return how many lines the cell's docstring takes; it must stay the first statement."""
    first, *_ = [*ast.parse(source).body, None]
    if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
        return first.end_lineno or 0
    return 0
