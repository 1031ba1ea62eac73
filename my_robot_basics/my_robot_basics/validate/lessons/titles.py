"""The title of a check: the first line of its docstring."""

import ast

from my_robot_basics.feedback.hidden_source import without_hidden_part


def title_of_failure(source: str) -> str:
    """Return the title of a check that failed only in its hidden part.

    For a check that is hidden as a whole, it is its own title.
    """
    title = title_of_check(source)
    return (
        f'Checked at grading, beyond “{title}”'
        if checks_something(without_hidden_part(source))
        else title
    )


def title_of_check(source: str) -> str:
    """Return the first line of a cell's docstring, or ''."""
    try:
        return (ast.get_docstring(ast.parse(source)) or '').partition('\n')[0]
    except (SyntaxError, ValueError):
        return ''


def checks_something(source: str) -> bool:
    """Whether the visible part of a check does more than import and print."""
    return not all(
        isinstance(node, ast.Import | ast.ImportFrom)
        or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
        or (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Call)
            and getattr(node.value.func, 'id', '') == 'print'
        )
        for node in ast.parse(source).body
    )
