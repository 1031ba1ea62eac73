"""What a check is called: the first line of its docstring, whatever is put before it."""

import ast


def title_of_check(source: str) -> str:
    """Return the first line of the first text that stands by itself in a cell, or ''."""
    try:
        body = ast.parse(source).body
    except (SyntaxError, ValueError):
        return ''
    values = (getattr(node.value, 'value', None) for node in body if isinstance(node, ast.Expr))
    text = next((value for value in values if isinstance(value, str)), '')
    return text.strip().partition('\n')[0]
