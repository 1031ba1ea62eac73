"""What a check is called: the first line of its docstring."""

import ast


def title_of_check(source: str) -> str:
    """Return the first line of a cell's docstring, or ''."""
    try:
        return (ast.get_docstring(ast.parse(source)) or '').partition('\n')[0]
    except (SyntaxError, ValueError):
        return ''
